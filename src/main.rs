fn main() {
    let d =
        resect::deployment::open(std::path::Path::new(&std::env::args().nth(1).unwrap())).unwrap();
    let mut s = resect::pipeline::PipelineSettings::default();
    for on in [true, false] {
        s.outlier_filter = on;
        s.interval_filter = on;
        let out = resect::pipeline::run(&d, &s);
        println!(
            "{} triplets {} of {} intervals kept {:?}",
            out.triplets.len(),
            out.kept_intervals.len(),
            out.intervals.len(),
            out.kept()
        );
        for prior in
            [resect::calibration::PriorMethod::ClosedForm, resect::calibration::PriorMethod::Search]
        {
            let cs = resect::calibration::CalibrationSettings { prior, ..Default::default() };
            let c = resect::calibration::solve(&d, &out.triplets, &cs).unwrap();
            println!(
                "{:#?}\n{:?}\n{:?} {:?} {} {}",
                c.basin, c.mirror, c.sigma, c.verdict, c.prior_ms, c.solve_ms
            );
            for f in &c.findings {
                println!("{f}");
            }
            let e = resect::calibration::inter_prism::distance_errors_m(
                &out.triplets,
                c.station1_from_station(),
                &d.rig.as_ref().unwrap().inter_prism_m,
            );
            let mut all: Vec<f64> = e.iter().flatten().copied().collect();
            all.sort_by(f64::total_cmp);
            let q = |a: &Vec<f64>, f: f64| a[(f * a.len() as f64) as usize] * 1e3;
            println!("signed q {} {} {}", q(&all, 0.25), q(&all, 0.5), q(&all, 0.75));
            let mut ab: Vec<f64> = all.iter().map(|v| v.abs()).collect();
            ab.sort_by(f64::total_cmp);
            println!("abs q {} {} {}", q(&ab, 0.25), q(&ab, 0.5), q(&ab, 0.75));
        }
    }
}
