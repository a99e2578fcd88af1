// Builds the page into the server's crate: names without hashes and no minification, so that its diffs can be read.
import { defineConfig } from 'vite';

export default defineConfig({
  base: './',
  build: {
    outDir: '../crates/server/page',
    emptyOutDir: true,
    target: 'es2022',
    minify: false,
    modulePreload: false,
    cssCodeSplit: false,
    assetsInlineLimit: 0,
    rolldownOptions: {
      // Of scenes, and of finished pictures.
      input: { app: 'index.html', pictures: 'pictures.html' },
      output: { entryFileNames: 'assets/[name].js', chunkFileNames: 'assets/[name].js', assetFileNames: 'assets/app.[ext]' },
    },
  },
});
