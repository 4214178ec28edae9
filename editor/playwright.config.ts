import { existsSync } from "node:fs";
import { defineConfig } from "@playwright/test";

/** Debian's Chromium, or the one that $CHROMIUM names; where there is neither, the one that `npx playwright install chromium` gets. */
const chromium = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser"].find(
  (path) => path && existsSync(path),
);

// A port of this run's own, which its workers find here.
process.env.NEURALMLS_PAGES_PORT ??= String(20_000 + (process.pid % 20_000));
const port = Number(process.env.NEURALMLS_PAGES_PORT);

export default defineConfig({
  projects: [
    { name: "e2e", testDir: "tests/e2e" },
    { name: "bench", testDir: "tests/bench" },
  ],
  outputDir: "test-results",
  // Two processors, and a graphics card in software.
  workers: 1,
  timeout: 60_000,
  expect: { timeout: 10_000 },
  reporter: "list",
  use: {
    viewport: { width: 1280, height: 720 },
    actionTimeout: 10_000,
    launchOptions: {
      ...(chromium ? { executablePath: chromium } : {}),
      args: [
        "--no-sandbox",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
      ],
    },
  },
  webServer: {
    // Pages of single parts, straight from their sources; the built editor is served by the package (fixtures.ts).
    command: `npx vite --port ${port} --strictPort`,
    env: { NEURALMLS_TEST: "1" },
    port,
  },
});
