/** Which of the two weights that live side by side: those that are edited, and those that they are compared with. A fit ends the older one of its slot only. */
export type Slot = "main" | "comparison";
