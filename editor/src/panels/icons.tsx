/** Line icons on a grid of 24. */

const PATHS = {
  open: "M3 7a2 2 0 0 1 2-2h4l2 2h8a2 2 0 0 1 2 2v8a2 2 0 0 1-2 2H5a2 2 0 0 1-2-2z",
  save: "M12 4v11m0 0 4-4m-4 4-4-4M5 19h14",
  undo: "M8 5 4 9l4 4M4 9h10a5.5 5.5 0 0 1 0 11h-3",
  redo: "m16 5 4 4-4 4m4-4H10a5.5 5.5 0 0 0 0 11h3",
  translate: "M12 3v18M3 12h18M12 3 9.5 5.5M12 3l2.5 2.5M12 21l-2.5-2.5M12 21l2.5-2.5M3 12l2.5-2.5M3 12l2.5 2.5M21 12l-2.5-2.5M21 12l-2.5 2.5",
  rotate: "M20 12a8 8 0 1 1-2.6-5.9M20 3v4h-4",
  scale: "M4 20V10m0 10h10M4 20 20 4m0 0h-6m6 0v6",
  add: "M12 5v14M5 12h14",
  box: "M4 7V4h3m3.5 0h3M17 4h3v3m0 3.5v3m0 3.5v3h-3m-3.5 0h-3M7 20H4v-3m0-3.5v-3M12 10v4m-2-2h4",
  frame: "M4 8V5a1 1 0 0 1 1-1h3m8 0h3a1 1 0 0 1 1 1v3m0 8v3a1 1 0 0 1-1 1h-3m-8 0H5a1 1 0 0 1-1-1v-3M12 9.5v5M9.5 12h5",
  before: "M12 3v18M5 7h3m-3 5h3m-3 5h3M15 6l5 6-5 6",
  compare: "M3.5 5h17v14h-17zM12 5v14",
  theme: "M12 3a9 9 0 1 0 0 18zM12 3a9 9 0 0 1 0 18",
  help: "M9 9a3 3 0 1 1 4.2 2.8c-.8.4-1.2 1-1.2 2M12 17.2v.1M21 12a9 9 0 1 1-18 0 9 9 0 0 1 18 0z",
  group: "M4 4h7v7H4zM13 13h7v7h-7zM11 7.5h5.5V13M7.5 11v5.5H13",
  lock: "M7 11V8a5 5 0 0 1 10 0v3M5.5 11h13v9h-13z",
  unlock: "M7 11V8a5 5 0 0 1 9.6-2M5.5 11h13v9h-13z",
  trash: "M5 7h14M10 7V4.5h4V7m-7.5 0 1 12.5h9l1-12.5M10 10.5v6m4-6v6",
  reset: "M4.5 12a7.5 7.5 0 1 0 2.4-5.5M4 4v4.5h4.5",
  mirror: "M12 3v18M9 7 3.5 17H9zM15 7l5.5 10H15z",
  wire: "M12 3 21 8v8l-9 5-9-5V8zM3 8l9 5 9-5M12 13v8",
  close: "m6 6 12 12M18 6 6 18",
  chevron: "m7 10 5 5 5-5",
  pin: "M12 21s7-6.4 7-11.5A7 7 0 0 0 5 9.5C5 14.6 12 21 12 21zM12 12a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5z",
  target: "M12 3v4m0 10v4M3 12h4m10 0h4M16.5 12a4.5 4.5 0 1 1-9 0 4.5 4.5 0 0 1 9 0z",
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg class="icon" viewBox="0 0 24 24" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}
