//! NIST's nonlinear sets: models with their derivatives, starts and certified values.
//!
//! Higher difficulty: MGH09, Thurber, BoxBOD, Rat42, MGH10, Eckerle4, Rat43. References: NIST StRD, Nonlinear
//! Regression; Misra, D., Chwirut, D., Rust, B., Thurber, R., Eckerle, K., NIST; Daniel, Wood (1980);
//! Lanczos, Applied Analysis (1956); Nelson, IEEE Trans. Reliab. 30 (1981) 149; Osborne (1972, MGH17);
//! Meyer (1970, MGH10); Kowalik, Osborne (1978, MGH09); Ratkowsky (1983); Box, Hunter, Hunter (1978).

use super::nonlinear_data as data;
use crate::classical::problem::LeastSquaresProblem;

/// Model as a function of parameters and predictors: its value and its derivatives by the parameters.
type Model = fn(&[f64], &[f64]) -> (f64, Vec<f64>);

/// One of NIST's nonlinear sets.
pub(super) struct NonlinearSet {
    pub(super) name: &'static str,
    model: Model,
    /// Predictors, one line per observation.
    predictors: Vec<Vec<f64>>,
    y: Vec<f64>,
    pub(super) starts: [&'static [f64]; 2],
    pub(super) certified: &'static [f64],
    pub(super) sum_of_squares: f64,
    /// Certified standard deviations of the parameters; empty if not transcribed.
    pub(super) std_errors: &'static [f64],
}

impl LeastSquaresProblem for NonlinearSet {
    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        self.predictors.iter().zip(&self.y).map(|(x, y)| (self.model)(parameters, x).0 - y).collect()
    }

    fn jacobian(&self, parameters: &[f64]) -> Vec<Vec<f64>> {
        let rows: Vec<Vec<f64>> = self.predictors.iter().map(|x| (self.model)(parameters, x).1).collect();
        (0..parameters.len()).map(|column| rows.iter().map(|row| row[column]).collect()).collect()
    }

    fn data_length(&self) -> f64 {
        self.y.iter().map(|y| y * y).sum::<f64>().sqrt()
    }
}

fn set(
    name: &'static str,
    model: Model,
    (x, y): (&[f64], &[f64]),
    starts: [&'static [f64]; 2],
    certified: &'static [f64],
    sum_of_squares: f64,
) -> NonlinearSet {
    assert_eq!(x.len(), y.len(), "{name}");
    NonlinearSet {
        name,
        model,
        predictors: x.iter().map(|&x| vec![x]).collect(),
        y: y.to_vec(),
        starts,
        certified,
        sum_of_squares,
        std_errors: &[],
    }
}

/// Returns NIST's lower level of difficulty, and Lanczos2, Nelson and MGH17 of the average level.
pub(super) fn easier() -> Vec<NonlinearSet> {
    let mut sets = vec![
        set(
            "Misra1a",
            misra_1a,
            (&data::MISRA_X, &data::MISRA_Y),
            [&[500.0, 1e-4], &[250.0, 5e-4]],
            &[2.389_421_291_8E+02, 5.501_564_318_1E-04],
            1.245_513_889_4E-01,
        ),
        set(
            "Misra1b",
            misra_1b,
            (&data::MISRA_X, &data::MISRA_Y),
            [&[500.0, 1e-4], &[300.0, 2e-4]],
            &[3.379_974_616_3E+02, 3.903_909_128_7E-04],
            7.546_468_153_3E-02,
        ),
        set(
            "Chwirut2",
            chwirut,
            (&data::CHWIRUT_2_X, &data::CHWIRUT_2_Y),
            [&[0.1, 0.01, 0.02], &[0.15, 0.008, 0.010]],
            &[1.665_766_653_7E-01, 5.165_329_128_6E-03, 1.215_000_709_6E-02],
            5.130_480_294_1E+02,
        ),
        set(
            "DanWood",
            power_law,
            (&[1.309, 1.471, 1.490, 1.565, 1.611, 1.680], &[2.138, 3.421, 3.597, 4.340, 4.882, 5.660]),
            [&[1.0, 5.0], &[0.7, 4.0]],
            &[7.688_622_617_6E-01, 3.860_405_587_1E+00],
            4.317_308_408_3E-03,
        ),
        set(
            "Lanczos2",
            three_exponentials,
            (&data::LANCZOS_X, &data::LANCZOS_2_Y),
            [&[1.2, 0.3, 5.6, 5.5, 6.5, 7.6], &[0.5, 0.7, 3.6, 4.2, 4.0, 6.3]],
            &[
                9.625_102_993_9E-02,
                1.005_733_284_9E+00,
                8.642_468_905_6E-01,
                3.007_828_391_5E+00,
                1.552_901_687_9E+00,
                5.002_879_810_0E+00,
            ],
            2.229_942_812_5E-11,
        ),
        set(
            "Lanczos3",
            three_exponentials,
            (&data::LANCZOS_X, &data::LANCZOS_3_Y),
            [&[1.2, 0.3, 5.6, 5.5, 6.5, 7.6], &[0.5, 0.7, 3.6, 4.2, 4.0, 6.3]],
            &[
                8.681_641_497_7E-02,
                9.549_810_150_5E-01,
                8.440_077_746_3E-01,
                2.951_595_183_2E+00,
                1.582_568_590_1E+00,
                4.986_356_508_4E+00,
            ],
            1.611_719_359_4E-08,
        ),
        set(
            "Gauss1",
            gaussians,
            (&(1..=250).map(f64::from).collect::<Vec<_>>(), &data::GAUSS_1_Y),
            [
                &[97.0, 0.009, 100.0, 65.0, 20.0, 70.0, 178.0, 16.5],
                &[94.0, 0.0105, 99.0, 63.0, 25.0, 71.0, 180.0, 20.0],
            ],
            &[
                9.877_821_087_1E+01,
                1.049_727_651_7E-02,
                1.004_899_063_3E+02,
                6.748_111_127_6E+01,
                2.312_977_336_0E+01,
                7.199_450_300_4E+01,
                1.789_980_502_1E+02,
                1.838_938_902_5E+01,
            ],
            1.315_822_243_2E+03,
        ),
        set(
            "MGH17",
            two_exponentials,
            (&(0..33).map(|i| f64::from(i) * 10.0).collect::<Vec<_>>(), &data::MGH_17_Y),
            [&[50.0, 150.0, -100.0, 1.0, 2.0], &[0.5, 1.5, -1.0, 0.01, 0.02]],
            &[
                3.754_100_521_1E-01,
                1.935_846_912_7E+00,
                -1.464_687_136_6E+00,
                1.286_753_464_0E-02,
                2.212_269_966_2E-02,
            ],
            5.464_894_697_5E-05,
        ),
        nelson(),
    ];
    for set in &mut sets {
        set.std_errors = match set.name {
            "Misra1a" => &[2.707_007_524_1E+00, 7.266_868_843_6E-06],
            "Lanczos3" => &[
                1.719_790_885_9E-02,
                9.704_162_447_5E-02,
                4.148_866_328_2E-02,
                1.076_631_250_6E-01,
                5.837_157_628_1E-02,
                3.443_640_303_5E-02,
            ],
            "MGH17" => &[
                2.072_315_355_1E-03,
                2.203_166_922_2E-01,
                2.217_570_773_9E-01,
                4.486_135_811_4E-04,
                8.947_199_657_5E-04,
            ],
            _ => &[],
        };
    }
    sets
}

/// Returns NIST's higher level of difficulty.
pub(super) fn harder() -> Vec<NonlinearSet> {
    let mut sets = vec![
        set(
            "MGH09",
            kowalik_osborne,
            (&data::MGH_09_X, &data::MGH_09_Y),
            [&[25.0, 39.0, 41.5, 39.0], &[0.25, 0.39, 0.415, 0.39]],
            &[1.928_069_345_8E-01, 1.912_823_287_3E-01, 1.230_565_069_3E-01, 1.360_623_306_8E-01],
            3.075_056_038_5E-04,
        ),
        set(
            "Thurber",
            cubic_ratio,
            (&data::THURBER_X, &data::THURBER_Y),
            [&[1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03], &[1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05]],
            &[
                1.288_139_680_0E+03,
                1.491_079_253_5E+03,
                5.832_383_687_7E+02,
                7.541_664_429_1E+01,
                9.662_950_286_4E-01,
                3.979_728_579_7E-01,
                4.972_729_734_9E-02,
            ],
            5.642_708_239_7E+03,
        ),
        set(
            "BoxBOD",
            misra_1a,
            (&[1.0, 2.0, 3.0, 5.0, 7.0, 10.0], &[109.0, 149.0, 149.0, 191.0, 213.0, 224.0]),
            [&[1.0, 1.0], &[100.0, 0.75]],
            &[2.138_094_088_9E+02, 5.472_374_854_2E-01],
            1.168_008_876_6E+03,
        ),
        set(
            "Rat42",
            logistic,
            (
                &[9.0, 14.0, 21.0, 28.0, 42.0, 57.0, 63.0, 70.0, 79.0],
                &[8.93, 10.8, 18.59, 22.33, 39.35, 56.11, 61.73, 64.62, 67.08],
            ),
            [&[100.0, 1.0, 0.1], &[75.0, 2.5, 0.07]],
            &[7.246_223_757_6E+01, 2.618_076_840_2E+00, 6.735_920_006_6E-02],
            8.056_522_933_8E+00,
        ),
        set(
            "MGH10",
            meyer,
            (&(0..16).map(|i| 50.0 + f64::from(i) * 5.0).collect::<Vec<_>>(), &data::MGH_10_Y),
            [&[2.0, 400_000.0, 25_000.0], &[0.02, 4000.0, 250.0]],
            &[5.609_636_471_0E-03, 6.181_346_346_3E+03, 3.452_236_346_2E+02],
            8.794_585_517_1E+01,
        ),
        set(
            "Eckerle4",
            line_shape,
            (&data::ECKERLE_4_X, &data::ECKERLE_4_Y),
            [&[1.0, 10.0, 500.0], &[1.5, 5.0, 450.0]],
            &[1.554_382_717_8E+00, 4.088_832_175_4E+00, 4.515_412_184_4E+02],
            1.463_588_748_7E-03,
        ),
        set(
            "Rat43",
            richards,
            (&(1..=15).map(f64::from).collect::<Vec<_>>(), &data::RAT_43_Y),
            [&[100.0, 10.0, 1.0, 1.0], &[700.0, 5.0, 0.75, 1.3]],
            &[6.996_415_127_0E+02, 5.277_125_302_5E+00, 7.596_293_832_9E-01, 1.279_248_385_9E+00],
            8.786_404_908_0E+03,
        ),
    ];
    for set in &mut sets {
        set.std_errors = match set.name {
            "Thurber" => &[
                4.664_796_334_4E+00,
                3.957_115_608_6E+01,
                2.869_869_610_2E+01,
                5.567_537_027_0E+00,
                3.133_334_068_7E-02,
                1.498_492_819_8E-02,
                6.584_234_462_3E-03,
            ],
            "MGH10" => &[1.568_789_247_1E-04, 2.330_902_110_7E+01, 7.848_610_350_8E-01],
            _ => &[],
        };
    }
    sets
}

/// Four observations at each of 8 times (weeks) and 4 temperatures (°C); the response is a logarithm.
fn nelson() -> NonlinearSet {
    let design = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 48.0, 64.0]
        .into_iter()
        .flat_map(|week| [180.0, 225.0, 250.0, 275.0].map(|temperature| [week, temperature]))
        .flat_map(|point| [point; 4]);
    NonlinearSet {
        name: "Nelson",
        model: degradation,
        predictors: design.map(|point| point.to_vec()).collect(),
        y: data::NELSON_Y.iter().map(|y| y.ln()).collect(),
        starts: [&[2.0, 1e-4, -0.01], &[2.5, 5e-9, -0.05]],
        certified: &[2.590_683_602_1E+00, 5.617_771_702_6E-09, -5.770_101_317_4E-02],
        sum_of_squares: 3.797_683_317_6E+00,
        std_errors: &[],
    }
}

fn misra_1a(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (-b[1] * x[0]).exp();
    (b[0] * (1.0 - e), vec![1.0 - e, b[0] * x[0] * e])
}

fn misra_1b(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let base = 1.0 + b[1] * x[0] / 2.0;
    let share = 1.0 - base.powi(-2);
    (b[0] * share, vec![share, b[0] * x[0] * base.powi(-3)])
}

fn chwirut(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let (e, q) = ((-b[0] * x[0]).exp(), b[1] + b[2] * x[0]);
    (e / q, vec![-x[0] * e / q, -e / (q * q), -x[0] * e / (q * q)])
}

fn power_law(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let power = x[0].powf(b[1]);
    (b[0] * power, vec![power, b[0] * power * x[0].ln()])
}

fn three_exponentials(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let terms = [0, 2, 4].map(|at| (b[at], (-b[at + 1] * x[0]).exp()));
    (
        terms.iter().map(|(factor, e)| factor * e).sum(),
        terms.iter().flat_map(|(factor, e)| [*e, -factor * x[0] * e]).collect(),
    )
}

fn gaussians(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (-b[1] * x[0]).exp();
    let mut value = b[0] * e;
    let mut slopes = vec![e, -b[0] * x[0] * e];
    for peak in [&b[2..5], &b[5..8]] {
        let distance = (x[0] - peak[1]) / peak[2];
        let bell = (-distance * distance).exp();
        value += peak[0] * bell;
        let side = peak[0] * bell * 2.0 * distance / peak[2];
        slopes.extend([bell, side, side * distance]);
    }
    (value, slopes)
}

fn two_exponentials(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let (one, two) = ((-b[3] * x[0]).exp(), (-b[4] * x[0]).exp());
    (b[0] + b[1] * one + b[2] * two, vec![1.0, one, two, -x[0] * b[1] * one, -x[0] * b[2] * two])
}

fn degradation(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (-b[2] * x[1]).exp();
    (b[0] - b[1] * x[0] * e, vec![1.0, -x[0] * e, b[1] * x[0] * x[1] * e])
}

fn kowalik_osborne(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let x = x[0];
    let (top, bottom) = (x * x + x * b[1], x * x + x * b[2] + b[3]);
    let slope = -b[0] * top / (bottom * bottom);
    (b[0] * top / bottom, vec![top / bottom, b[0] * x / bottom, slope * x, slope])
}

fn cubic_ratio(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let powers = [1.0, x[0], x[0] * x[0], x[0] * x[0] * x[0]];
    let top: f64 = (0..4).map(|k| b[k] * powers[k]).sum();
    let bottom = 1.0 + (1..4).map(|k| b[k + 3] * powers[k]).sum::<f64>();
    let up = powers.iter().map(|power| power / bottom);
    let down = powers[1..].iter().map(|power| -top * power / (bottom * bottom));
    (top / bottom, up.chain(down).collect())
}

fn logistic(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (b[1] - b[2] * x[0]).exp();
    let slope = -b[0] * e / ((1.0 + e) * (1.0 + e));
    (b[0] / (1.0 + e), vec![1.0 / (1.0 + e), slope, -slope * x[0]])
}

fn meyer(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let q = 1.0 / (x[0] + b[2]);
    let e = (b[1] * q).exp();
    (b[0] * e, vec![e, b[0] * q * e, -b[0] * b[1] * q * q * e])
}

fn line_shape(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let distance = (x[0] - b[2]) / b[1];
    let bell = (-0.5 * distance * distance).exp() / b[1];
    let value = b[0] * bell;
    (value, vec![bell, value * (distance * distance - 1.0) / b[1], value * distance / b[1]])
}

fn richards(b: &[f64], x: &[f64]) -> (f64, Vec<f64>) {
    let e = (b[1] - b[2] * x[0]).exp();
    let power = (1.0 + e).powf(-1.0 / b[3]);
    let slope = -b[0] * power * e / ((1.0 + e) * b[3]);
    (b[0] * power, vec![power, slope, -slope * x[0], b[0] * power * e.ln_1p() / (b[3] * b[3])])
}
