import { defineConfig } from '@playwright/test';
import base from '../playwright.config';

export default defineConfig({ ...base, testDir: '.', use: { ...base.use, viewport: { width: 800, height: 520 }, acceptDownloads: true } });
