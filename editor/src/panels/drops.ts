import type { App } from "../app/app.ts";

/** Files that are dropped anywhere on the page. */
export function listenToDrops(app: App): void {
  const page = document.documentElement;
  let depth = 0;
  const mark = (change: number): void => {
    depth = Math.max(0, depth + change);
    page.classList.toggle("dropping", depth > 0);
  };
  const hasFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  window.addEventListener("dragenter", (event) => hasFiles(event) && mark(1));
  window.addEventListener("dragleave", (event) => hasFiles(event) && mark(-1));
  window.addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault());
  window.addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    mark(-depth);
    void app.openFiles([...(event.dataTransfer?.files ?? [])]);
  });
}
