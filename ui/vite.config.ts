import react from "@vitejs/plugin-react";
import { defineConfig, type Plugin } from "vite";

/** Of a page's file, asked for with `?about`, only what it says of itself: what it shows is loaded when it is asked for. */
const about: Plugin = {
  name: "about",
  enforce: "pre",
  transform(code, id) {
    if (!id.endsWith("?about")) return undefined;
    const said = /^export const page = \{.*?\};$/ms.exec(code);
    return said ? `import { ICONS } from "../parts/Icon";\n${said[0]}` : this.error("expected `export const page = {…};`");
  },
};

export default defineConfig({
  base: "./",
  plugins: [about, react()],
  build: {
    outDir: "../src/robophm/web/static",
    emptyOutDir: true,
    assetsInlineLimit: 0, // nothing as data: the service's policy refuses it
    modulePreload: { polyfill: false },
    target: "es2022",
    license: { fileName: "licenses.md" }, // of all that is bundled, their texts
    sourcemap: false,
    chunkSizeWarningLimit: 450,
  },
  server: { proxy: { "/api": { target: "http://127.0.0.1:8707", ws: true } } },
});
