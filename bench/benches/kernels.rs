//! The kernels one by one, for work on a single one: `cargo bench -p eclss-bench -- relaxation`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use eclss_bench::{Description, Runner, floor::Floor};
use eclss_core::Method;

const STEP_US: u32 = 1_000;

/// Benchmarks one method on one network with `equations` equations.
fn step(criterion: &mut Criterion, group: &str, method: Method, description: &Description, equations: usize) {
    let network = description.network();
    let mut runner = Runner::new(&network, method);
    let mut simulator = runner.simulator(&network, method, STEP_US).expect("the method takes this network");
    let mut group = criterion.benchmark_group(group);
    group.throughput(Throughput::Elements(equations as u64));
    group.bench_function(BenchmarkId::new(method.name(), equations), |bencher| {
        bencher.iter(|| black_box(simulator.step()));
    });
    group.finish();
}

fn floor(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("floor");
    for equations in [1_100, 2_000, 20_000] {
        let mut floor = Floor::new(equations);
        group.throughput(Throughput::Elements(equations as u64));
        group.bench_function(BenchmarkId::new("floor", equations), |bencher| bencher.iter(|| floor.run()));
    }
    group.finish();
}

fn kernels(criterion: &mut Criterion) {
    floor(criterion);
    for equations in [100, 1_100] {
        let chain = Description::paper_chain(equations);
        for method in [Method::Euler, Method::Relaxation, Method::ImplicitEuler, Method::TrBdf2] {
            step(criterion, "line", method, &chain, equations);
        }
    }
    for nodes in [1_000, 10_000] {
        let chain = Description::node_chain(nodes);
        for method in [Method::Adaptive, Method::ImplicitEuler, Method::TrBdf2] {
            step(criterion, "nodes", method, &chain, 2 * nodes);
        }
    }
}

criterion_group!(benches, kernels);
criterion_main!(benches);
