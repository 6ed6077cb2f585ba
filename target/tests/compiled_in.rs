//! A step that is specialised for the compiled-in network has the bits of the general one.

use eclss_core::{Buffers, Simulator};
use eclss_network_file::parse;
use eclss_target::network;
use eclss_target::plant::Plant as _;

#[test]
fn the_specialised_step_has_the_bits_of_the_general_one() {
    let text = include_str!("../../networks/paper.toml");
    let loaded = Box::leak(Box::new(parse(text, "paper.toml").expect("it ships")));
    let network = Box::leak(Box::new(loaded.network()));
    let settings = eclss_core::Settings { method: loaded.run.method, step_us: loaded.run.step_us };
    let sizes = settings.method.sizes(network);
    let zeros = |length| Box::leak(vec![0.0; length].into_boxed_slice());
    let buffers = Buffers {
        state: zeros(sizes.state),
        work: zeros(sizes.work),
        inputs: zeros(sizes.inputs),
        cursors: Box::leak(vec![0; sizes.cursors].into_boxed_slice()),
    };
    let simulator = Simulator::new(network, settings, buffers).expect("the network is accepted");
    let mut general = network::loaded(simulator, "paper", &[]);
    let mut specialised = network::compiled_in().expect("the network is accepted");
    assert_eq!(specialised.network_id(), general.network_id());
    for tick in 0..26_000 {
        assert_eq!((specialised.step(), general.step()), (Ok(()), Ok(())), "tick {tick}");
    }
    assert_eq!(specialised.state_hash(), general.state_hash());
    assert_eq!(specialised.outputs(), general.outputs());
}
