//! How long the benchmarks look at each case.

use std::time::Duration;

use criterion::Criterion;

pub(crate) fn settings() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
}
