/** Exposures by the picture, as `--exposure auto` and the defaults of models choose them. */

import { bins, percentile, type Statistics } from './half';

/** Luminance of mid-grey, and of what is bright but not white. */
const GREY = 0.18;
const BRIGHT = 0.8;
/** Value below which a display shows black, if nearly all of a picture lies there. */
const DARK = 0.02;

/** Stops, to a tenth, by which the geometric mean of what is lit becomes mid-grey, but no more than a tenth of it white; `null` where nothing is lit. */
export function averageStops(of: Statistics): number | null {
  const high = percentile(of, 0.9);
  const mean = meanLog2(of);
  if (high === null || mean === null) return null;
  return Math.round(10 * Math.min(Math.log2(GREY) - mean, -Math.log2(high))) / 10;
}

/** Stops that show more of a picture that is white or black as it is; `null` where it is neither. */
export function neededStops(of: Statistics): number | null {
  const [low, middle, high] = [percentile(of, 0.4), percentile(of, 0.5), percentile(of, 0.98)];
  if (low === null || middle === null || high === null) return null;
  if (low > 1) return Math.round(Math.log2(GREY / middle));
  return high < DARK ? Math.round(Math.log2(BRIGHT / high)) : null;
}

/** Mean binary logarithm of the luminances above zero. */
function meanLog2(of: Statistics): number | null {
  let [sum, count] = [0, 0];
  for (const [luminance, pixels] of bins(of)) {
    sum += pixels * Math.log2(luminance);
    count += pixels;
  }
  return count > 0 ? sum / count : null;
}
