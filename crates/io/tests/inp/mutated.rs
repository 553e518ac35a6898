//! Damaged files.

use powerhouse_io::parse_inp;

use super::sample::{HOUSE, house_of_parts, read};

/// Pseudo-random numbers, the same in every run (Steele, Lea, Flood 2014, SplitMix64).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound as u64) as usize
    }
}

/// A file with changed bytes, or with passages lost, doubled or moved, is refused with a line, or gives a valid mesh; nothing
/// panics.
#[test]
fn damage_never_panics() {
    let mut random = Random(1);
    let mut read = 0;
    let second =
        "*End Instance\n*Instance, name=b, part=Part-1\n0, 0, 7\n0,0,0, 1,1,1, 120\n*End Instance";
    let several = house_of_parts().replacen("*End Instance", second, 1);
    let shells = HOUSE.replacen(
        "*NSET",
        "*ELEMENT, TYPE=CPS4, ELSET=s\n11, 1, 2, 3, 4\n*ELEMENT, TYPE=MASS\n12, 1\n*NSET",
        1,
    );
    let wedge = HOUSE
        .replacen("2, 5, 9, 6, 8, 10, 7", "2, 5, 5, 6, 6, 8, 8, 7, 10", 1)
        .replacen("TYPE=C3D6", "TYPE=C3D8", 1);
    for file in [HOUSE.to_owned(), house_of_parts(), several, shells, wedge] {
        let lines = file.lines().count();
        for round in 0..6_000 {
            let mut changed = file.clone().into_bytes();
            if round % 2 == 0 {
                for _ in 0..1 + round % 3 {
                    let at = random.below(changed.len());
                    let any = random.bits() as u8;
                    changed[at] = match random.below(3) {
                        0 => any,
                        1 => changed[at] ^ (1 << (any % 8)),
                        _ => b"0123456789 \n*,=.S\"\xff"[any as usize % 19],
                    };
                }
            } else {
                let mut ends = [random.below(file.len()), random.below(file.len())];
                ends.sort_unstable();
                let passage = changed[ends[0]..ends[1]].to_vec();
                if round % 4 == 1 {
                    changed.drain(ends[0]..ends[1]);
                }
                let target = random.below(changed.len().max(1));
                changed.splice(
                    target..target,
                    passage.iter().copied().take(random.below(200)),
                );
            }
            match parse_inp(&changed) {
                Ok(mesh) => {
                    read += 1;
                    assert!(mesh.mesh.check().is_ok());
                }
                Err(error) => {
                    let message = error.to_string();
                    let number = message.strip_prefix("line ").unwrap();
                    let digits = number.find(|c: char| !c.is_ascii_digit()).unwrap();
                    let line: usize = number[..digits].parse().unwrap();
                    assert!((1..=2 * lines + 200).contains(&line), "{message}");
                }
            }
        }
    }
    // Coordinates, names and skipped keywords may change without a trace, so some are read.
    assert!(read > 0);
}

/// A file of parts that is cut off before the end of its assembly is refused, unless it ends with its part.
#[test]
fn a_cut_file_of_parts_is_refused() {
    let text = house_of_parts();
    let end = text.find("*End Assembly").unwrap();
    let part = text.find("*End Part").unwrap() + "*End Part".len();
    let whole = read(&text).mesh;
    for length in 0..end {
        if let Ok(cut) = parse_inp(&text.as_bytes()[..length]) {
            assert!((part..part + 12).contains(&length), "cut at {length}");
            assert_eq!(cut.mesh.positions(), whole.positions());
            assert!(cut.mesh.facet_sets().is_empty());
        }
    }
}
