use super::*;
use crate::network::{PerPair, Prism};
use crate::pipeline::Triplets;

fn triplets(stations: usize) -> Triplets {
    let points = |k: f64| -> Vec<Vector3<f64>> {
        (0..3)
            .map(|i| {
                Vector3::new(
                    20.0 + 0.1 * f64::from(i) + k,
                    7.0 - k * 0.6,
                    0.3 * k + 0.02 * f64::from(i),
                )
            })
            .collect()
    };
    let points_m: PerStation<_> = (0..stations).map(|k| points(k as f64)).collect();
    Triplets::new(vec![0.0, 0.1, 0.2], vec![0; 3], points_m)
}

fn assert_derivatives_are_the_differences(network: &PrismNetwork, values: &[f64]) {
    let triplets = triplets(network.stations());
    let data = MovingTriplets::all(&triplets);
    let model = ClockCheckModel::new(network);
    let mut state = State::zeros(model.order());
    state.rows_mut(0, values.len()).copy_from_slice(values);
    let residuals_m = |state: &State| -> Vec<f64> {
        let all = residuals(&model, &data, 1, state, &model.transforms(state));
        all.iter().map(|residual| residual.residual_m).collect()
    };
    let no_noise = vec![vec![Matrix3::zeros(); network.pairs.len()]; 3];
    let here = LinearisedTriplets::at(&model, &data, &state, &no_noise);
    let rows = here.per_triplet..2 * here.per_triplet;
    assert_eq!(here.residual_m[rows.clone()], residuals_m(&state));
    for unknown in 0..=model.constant() {
        let step = 1e-6;
        let (mut up, mut down) = (state.clone(), state.clone());
        up[unknown] += step;
        down[unknown] -= step;
        let (up, down) = (residuals_m(&up), residuals_m(&down));
        for (index, row) in rows.clone().enumerate() {
            let numeric = (up[index] - down[index]) / (2.0 * step);
            let exact = here.derivative(row)[unknown];
            assert!(
                (numeric - exact).abs() < 2e-4 * (1.0 + exact.abs()),
                "{unknown} {index}: {numeric} {exact}"
            );
        }
    }
}

#[test]
fn derivatives_are_the_differences() {
    let values = [
        0.3, -0.2, 0.5, 0.4, -0.6, 0.1, 0.2, -0.3, 0.004, -0.003, 0.7, 0.9, 1.0, 1e-6, -2e-6, 3e-6,
        1e-6, 2e-3, -1e-3, 4e-4,
    ];
    let network = PrismNetwork::of_own_prisms([0.7, 0.9, 1.0]);
    assert_eq!(ClockCheckModel::new(&network).order(), values.len());
    assert_derivatives_are_the_differences(&network, &values);
}

#[test]
fn derivatives_of_shared_prisms_are_the_differences() {
    let prisms = PerStation::from([0, 1, 1, 0].map(Prism::at));
    let network = PrismNetwork::new(prisms, &PerPair::from([0.8]));
    let values = [
        0.3, -0.2, 0.5, 0.4, -0.6, 0.1, 0.2, -0.3, 0.2, 0.5, -0.4, 0.7, 0.004, -0.003, 0.002, 0.8,
        1e-6, -2e-6, 3e-6, 1e-6, -1e-6, 2e-6, 2e-3, -1e-3, 3e-3, 4e-4,
    ];
    let model = ClockCheckModel::new(&network);
    assert_eq!((model.constant() + 1, model.residuals.len()), (values.len(), 10));
    assert_derivatives_are_the_differences(&network, &values);
}

#[test]
fn noise_is_the_range_s_along_the_sight_and_the_angle_s_across() {
    let noise = PolarNoise { range_m: 0.002, range_share: 2e-6, angle_rad: 5e-6 };
    let point = Vector3::new(100.0, 0.0, 0.0);
    let covariance = noise.covariance_m2(&point);
    let (along, across) = (covariance[(0, 0)].sqrt(), covariance[(1, 1)].sqrt());
    assert!((along - 0.0022).abs() < 1e-9 && (across - 0.0005).abs() < 1e-9, "{along} {across}");
}
