import { defineConfig } from "vitest/config";

export default defineConfig({
  base: "/window/",
  oxc: { jsx: { runtime: "automatic", importSource: "preact" } },
  build: {
    outDir: "../src/jackettwin/service/window",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
  },
  server: { proxy: { "/api": "http://127.0.0.1:8470" } },
  test: { include: ["tests/**/*.test.ts"] },
});
