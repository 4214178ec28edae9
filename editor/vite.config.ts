import { defineConfig } from "vitest/config";
import { contentSecurityPolicy, fileOfPolicy } from "./security.ts";

export default defineConfig({
  base: "./",
  plugins: [
    {
      // In the page for static hosting, where nobody sends headers; beside it for `neuralmls edit`, which does. Not in development, whose hot reloading needs inline scripts.
      name: "content-security-policy",
      apply: "build",
      generateBundle() {
        this.emitFile({ type: "asset", fileName: fileOfPolicy, source: contentSecurityPolicy });
      },
      transformIndexHtml: () => [
        {
          tag: "meta",
          attrs: { "http-equiv": "Content-Security-Policy", content: contentSecurityPolicy },
          injectTo: "head-prepend",
        },
      ],
    },
  ],
  // A page under test must not be loaded anew because a file has changed.
  ...(process.env.NEURALMLS_TEST ? { server: { hmr: false, watch: null } } : {}),
  worker: { format: "es" },
  build: {
    outDir: "../python/neuralmls/editor_server/static",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 2000,
  },
  test: {
    include: ["{src,tests/unit}/**/*.test.{ts,tsx}"],
  },
});
