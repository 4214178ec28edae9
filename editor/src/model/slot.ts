/** Which of the two weights that live side by side: those that are edited, and those that they are compared with. */
export type Slot = "main" | "comparison";
