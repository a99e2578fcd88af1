//! Purpose of filtering: the picture looks as it should, and is as bright as it was.

use steradian_denoise::{Image, svgf::Settings};
use steradian_math::{Vec3, color::luminance};

use crate::moving::last_frame;

/// The window: a Gaussian of 1.5 pixels over 11×11.
const RADIUS: i64 = 5;
const SIGMA: f64 = 1.5;

/// The mean structural similarity of luminances, 1 for the same picture (Wang, Bovik, Sheikh and Simoncelli, "Image
/// Quality Assessment: From Error Visibility to Structural Similarity", IEEE TIP 13(4), 2004), of windows within the
/// picture.
fn ssim(a: &Image<Vec3>, b: &Image<Vec3>, range: f64) -> f64 {
    let [c1, c2] = [0.01, 0.03].map(|k: f64| (k * range).powi(2));
    let gaussian = |d: i64| (-0.5 * (d as f64 / SIGMA).powi(2)).exp();
    let total = (-RADIUS..=RADIUS).map(gaussian).sum::<f64>().powi(2);
    let (mut sum, mut windows) = (0.0, 0.0);
    for y in RADIUS..i64::from(a.height()) - RADIUS {
        for x in RADIUS..i64::from(a.width()) - RADIUS {
            // Means of both, of their squares, and of their product.
            let mut means = [0.0; 5];
            for (i, j) in (-RADIUS..=RADIUS).flat_map(|j| (-RADIUS..=RADIUS).map(move |i| (i, j))) {
                let [p, q] =
                    [a, b].map(|picture| f64::from(luminance(*picture.get((x + i) as u32, (y + j) as u32).unwrap())));
                let products = [p, q, p * p, q * q, p * q];
                means.iter_mut().zip(products).for_each(|(m, v)| *m += v * gaussian(i) * gaussian(j) / total);
            }
            let [p, q, pp, qq, pq] = means;
            let (variances, covariance) = (pp - p * p + qq - q * q, pq - p * q);
            sum += (2.0 * p * q + c1) * (2.0 * covariance + c2) / ((p * p + q * q + c1) * (variances + c2));
            windows += 1.0;
        }
    }
    sum / windows
}

fn brightest(picture: &Image<Vec3>) -> f64 {
    picture.values().iter().map(|color| f64::from(luminance(*color))).fold(0.0, f64::max)
}

#[test]
fn the_picture_becomes_similar_to_the_true_one() {
    for seed in 200..203 {
        let (truth, single, filtered, fresh) = last_frame(Settings::default(), seed);
        let of = |picture| ssim(picture, &truth, brightest(&truth));
        let [single, filtered, fresh] = [of(&single), of(&filtered.radiance), of(&fresh.radiance)];
        assert!((of(&truth) - 1.0).abs() < 1e-12);
        assert!(single < 0.4 && filtered > 0.995 && fresh < filtered, "{filtered} of {single}; {fresh} from one frame");
    }
}

/// The mean and standard deviation of numbers.
fn statistics(numbers: &[f64]) -> (f64, f64) {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    (mean, (numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}

/// Over many runs, what goes on to the next frame is no brighter and no darker than the truth. Wide filters, which
/// light is not linear beneath, may change it by a fraction of the noise of a frame's mean.
#[test]
fn the_mean_stays() {
    let mean = |picture: &Image<Vec3>| {
        picture.values().iter().map(|color| f64::from(luminance(*color))).sum::<f64>() / picture.values().len() as f64
    };
    const RUNS: u64 = 64;
    for iterations in [0, 1, 5] {
        let settings = Settings { iterations, ..Settings::default() };
        let runs = (0..RUNS).map(|seed| last_frame(settings, 300 + seed)).map(|(truth, single, filtered, _)| {
            [&single, &filtered.radiance].map(|picture| mean(picture) / mean(&truth) - 1.0)
        });
        let (single, filtered): (Vec<f64>, Vec<f64>) = runs.map(|[single, filtered]| (single, filtered)).unzip();
        let (_, noise) = statistics(&single);
        let (bias, spread) = statistics(&filtered);
        let sigma = spread / (RUNS as f64).sqrt();
        let most = if iterations <= 1 { 3.5 * sigma } else { 0.25 * noise };
        assert!(spread < noise && noise < 0.03, "{spread} of {noise}");
        assert!(bias.abs() < most, "{bias} ± {sigma} after {iterations}, {noise} for one frame");
    }
}
