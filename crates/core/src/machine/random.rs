//! Random numbers: what one seed means on every machine.

use rand_chacha::rand_core::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::memory::filled;

/// A generator.
pub(crate) struct Random(ChaCha8Rng);

impl Random {
    pub(crate) fn new(seed: u64) -> Random {
        Random(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in [0, 1), with the 53 bits that a number has.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// The same with the 24 bits that a single-precision number has.
    pub(crate) fn unit_single(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1u32 << 24) as f32
    }

    /// The next `count` numbers, uniform in `+-bound`: the generator can begin anywhere, so that each thread draws its own.
    pub(crate) fn uniform(&mut self, count: usize, bound: f32) -> Vec<f32> {
        const BLOCK: usize = 1 << 14;
        let begin = self.0.get_word_pos();
        self.0.set_word_pos(begin + count as u128);
        let generator = &self.0;
        filled(Vec::new(), count, 0.0, BLOCK, |index, block| {
            let mut random = Random(generator.clone());
            random.0.set_word_pos(begin + (BLOCK * index) as u128);
            block.iter_mut().for_each(|value| *value = (2.0 * random.unit_single() - 1.0) * bound);
        })
    }

    /// Puts the numbers in an order of which all are equally likely (Fisher, Yates 1938; Durstenfeld 1964).
    pub(crate) fn shuffle(&mut self, numbers: &mut [usize]) {
        for last in (1..numbers.len()).rev() {
            // The product's high half: uniform but for one part in 2^32 / len.
            let at = (u64::from(self.0.next_u32()) * (last as u64 + 1)) >> 32;
            numbers.swap(last, at as usize);
        }
    }

    /// Leaves `count` of the items, each as likely as another (Fisher and Yates); all if there are no more.
    pub(crate) fn choose(&mut self, items: &mut Vec<u32>, count: usize) {
        if items.len() <= count {
            return;
        }
        for i in 0..count {
            let j = i + (self.unit() * (items.len() - i) as f64) as usize;
            items.swap(i, j);
        }
        items.truncate(count);
    }
}
