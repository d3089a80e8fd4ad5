//! Choice of the cuts, which are tried in parallel.

use std::env;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

/// Seed of a run's draws: a new one each time, unless `MYOINTENT_SEED` gives it.
pub fn seed() -> u64 {
    let given = env::var("MYOINTENT_SEED").ok();
    given.map_or_else(
        || {
            let now = SystemTime::now().duration_since(UNIX_EPOCH);
            now.map_or(0, |now| u64::from(now.subsec_nanos()))
        },
        |seed| seed.parse().expect("MYOINTENT_SEED: a number"),
    )
}

/// Tries a cut at each of `must`, and at `few` others below `all`, or at all of them: on as many threads as the machine has.
///
/// # Panics
/// Panics if one fails, with all that failed.
pub fn each(
    all: usize,
    must: &[usize],
    few: usize,
    seed: u64,
    cut: impl Fn(usize) -> anyhow::Result<()> + Sync,
) {
    let mut others: Vec<_> = (0..all).filter(|place| !must.contains(place)).collect();
    others.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    if env::var("MYOINTENT_CUTS").is_err() {
        others.truncate(few);
    }
    let places = [must, &others].concat();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut failed = Vec::new();
        while let Some(&place) = places.get(next.fetch_add(1, Ordering::Relaxed)) {
            if let Err(error) = cut(place) {
                failed.push(format!("{place}: {error:#}"));
            }
        }
        failed
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let failed: Vec<_> = thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let failed = threads.into_iter().flat_map(|one| one.join().unwrap());
        failed.collect()
    });
    println!("{} of {all} places, MYOINTENT_SEED={seed}", places.len());
    assert!(
        failed.is_empty(),
        "{} of {}, the first: {}",
        failed.len(),
        places.len(),
        failed[0]
    );
}
