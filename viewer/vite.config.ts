import { defineConfig } from 'vite';

// `npm run dev` shows the page as it is edited; what it asks for goes to a running `taut view`: TAUT_VIEW is the address that it printed.
const server = process.env.TAUT_VIEW;

export default defineConfig({
  base: './',
  build: { outDir: '../build/viewer', emptyOutDir: true, target: 'es2022', modulePreload: false, chunkSizeWarningLimit: 1000 },
  server: server
    ? { host: '127.0.0.1', proxy: { '/api': { target: new URL(server).origin, changeOrigin: true, rewrite: (path) => new URL(server).pathname + path.slice(1) } } }
    : { host: '127.0.0.1' },
});
