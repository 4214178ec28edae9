import { defineConfig } from "vite";

/** The program of pages that are dragged offline, as one classic script that the editor puts into them. */
export default defineConfig({
  publicDir: false,
  build: {
    outDir: "public",
    emptyOutDir: false,
    target: "es2022",
    lib: { entry: "src/offline/main.ts", formats: ["iife"], name: "offline", fileName: () => "offline.js" },
  },
});
