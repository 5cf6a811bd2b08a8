//! The loaders on files that no one would write: small good files (tests/corpus/seeds), mutated.
//!
//! Whatever the bytes are, a loader returns: a scene that is sound, or an error of one line. It
//! does not panic, takes no more than two seconds and no memory beyond reason. The default run is
//! short; `FUZZ_SECONDS=600 cargo test -p common --test fuzz_loaders` is a long one, and each has
//! other mutations. What is found is kept in tests/corpus/found and replayed ever after.
#![cfg(feature = "files")]

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use common::scene::load::load;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Longest that a load may take.
const MAX_TIME: Duration = Duration::from_secs(2);

/// Most that the peak of this process's memory may grow by in one load \[KiB\]. A picture of the
/// largest size alone takes most of it.
const MAX_GROWTH: u64 = 3 << 20;

/// A change of a file; places are fractions of its length in 1/65536.
#[derive(Clone, Debug)]
enum Mutation {
    Flip(u16, u8),
    Set(u16, u8),
    Cut(u16),
    Remove(u16, u8),
    Repeat(u16, u8, u16),
    Number(u16, usize),
    Word(u16, u16, u16),
    Splice(u16, u16, u8),
}

/// What stands in for a number in the text.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "255",
    "65535",
    "65536",
    "-32768",
    "2147483647",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "1e-40",
    "1e9",
    "1e30",
    "3.5e38",
    "-1e38",
    "1e999",
    "nan",
    "-inf",
    "1.#IND",
    "0.99",
    "1e-7",
    "5120",
    "5121",
    "5125",
    "100000000",
    "[]",
    "{}",
    "null",
    "\"x\"",
    "1/2/3",
    "-1//-1",
    "1//",
    "/",
    "\\",
];

fn mutation() -> impl Strategy<Value = Mutation> {
    use Mutation::*;
    let (at, byte) = (any::<u16>(), any::<u8>());
    prop_oneof![
        2 => (at, 0..8u8).prop_map(|(at, bit)| Flip(at, bit)),
        1 => (at, byte).prop_map(|(at, value)| Set(at, value)),
        1 => at.prop_map(Cut),
        1 => (at, 1..64u8).prop_map(|(at, length)| Remove(at, length)),
        1 => (at, 1..=255u8, at).prop_map(|(from, length, to)| Repeat(from, length, to)),
        6 => (at, 0..NUMBERS.len()).prop_map(|(at, number)| Number(at, number)),
        2 => (at, at, at).prop_map(|(at, seed, from)| Word(at, seed, from)),
        1 => (at, at, 1..64u8).prop_map(|(at, from, length)| Splice(at, from, length)),
    ]
}

/// Ranges of the maximal runs of bytes that `is_inside`.
fn runs(bytes: &[u8], is_inside: impl Fn(u8) -> bool) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (at, _) in bytes.iter().enumerate().filter(|(_, b)| is_inside(**b)) {
        match runs.last_mut() {
            Some((_, end)) if *end == at => *end = at + 1,
            _ => runs.push((at, at + 1)),
        }
    }
    runs
}

fn is_of_number(b: u8) -> bool {
    b.is_ascii_digit() || b"+-.".contains(&b)
}

fn is_of_word(b: u8) -> bool {
    b.is_ascii_alphanumeric() || b"_-.".contains(&b)
}

fn scaled(fraction: u16, length: usize) -> usize {
    (usize::from(fraction) * length) >> 16
}

fn mutate(bytes: &mut Vec<u8>, mutation: &Mutation, seeds: &[Seed]) {
    let length = bytes.len();
    if length == 0 {
        return;
    }
    let at = |fraction: u16| scaled(fraction, length);
    match *mutation {
        Mutation::Flip(place, bit) => bytes[at(place)] ^= 1 << bit,
        Mutation::Set(place, value) => bytes[at(place)] = value,
        Mutation::Cut(place) => bytes.truncate(at(place)),
        Mutation::Remove(place, count) => {
            bytes.drain(at(place)..(at(place) + usize::from(count)).min(length));
        }
        Mutation::Repeat(from, count, to) => {
            let piece = bytes[at(from)..(at(from) + usize::from(count)).min(length)].to_vec();
            bytes.splice(at(to)..at(to), piece);
        }
        Mutation::Number(place, number) => {
            let numbers = runs(bytes, is_of_number);
            if let Some(&(start, end)) = numbers.get(scaled(place, numbers.len())) {
                bytes.splice(start..end, NUMBERS[number].bytes());
            }
        }
        Mutation::Word(place, seed, from) => {
            let donor = &seeds[scaled(seed, seeds.len())].bytes;
            let (words, donors) = (runs(bytes, is_of_word), runs(donor, is_of_word));
            let source = donors.get(scaled(from, donors.len()));
            if let (Some(&(start, end)), Some(&(from, to))) = (words.get(scaled(place, words.len())), source)
            {
                bytes.splice(start..end, donor[from..to].iter().copied());
            }
        }
        Mutation::Splice(place, from, count) => {
            let donor = &seeds[scaled(from, seeds.len())].bytes;
            let start = scaled(from.rotate_left(5), donor.len());
            let piece = donor[start..(start + usize::from(count)).min(donor.len())].to_vec();
            bytes.splice(at(place)..at(place), piece);
        }
    }
}

/// A file that is mutated: its name says how it is loaded.
struct Seed {
    name: String,
    bytes: Vec<u8>,
}

fn corpus(folder: &str) -> Vec<Seed> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(folder);
    let Ok(entries) = fs::read_dir(path) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("entry").path()).collect();
    paths.sort();
    let seed = |path: &PathBuf| Seed {
        name: path.file_name().expect("a name").to_string_lossy().into_owned(),
        bytes: fs::read(path).expect("readable"),
    };
    paths.iter().map(seed).collect()
}

/// A folder with the seeds in it, where mutants are loaded.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new(seeds: &[Seed]) -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        for seed in seeds {
            fs::write(folder.path().join(&seed.name), &seed.bytes).expect("writable");
        }
        // Light maps are reached by way of a scene file.
        for kind in ["png", "exr", "jpg"] {
            let text = format!(
                r#"{{"version": 1, "lights": [{{"spot": {{"position": [0, 0, 0], "direction": [0, 0, 1],
                "intensity": 1, "outer_angle_degrees": 20, "light_map": "mutant.{kind}"}}}}]}}"#
            );
            fs::write(folder.path().join(format!("with_{kind}.json")), text).expect("writable");
        }
        let obj =
            "mtllib mutant.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl stone\nf 1 2 3\nusemtl glass\nf 1 3 2\n";
        fs::write(folder.path().join("with_mtl.obj"), obj).expect("writable");
        Self(folder)
    }

    /// Loads `bytes` as a file of that name's kind; says what went wrong, if anything did.
    fn run(&self, name: &str, bytes: &[u8]) -> Result<(), String> {
        let kind = name.rsplit('.').next().expect("an extension");
        let mutant = self.0.path().join(format!("mutant.{kind}"));
        fs::write(&mutant, bytes).expect("writable");
        let entry = match kind {
            "png" | "exr" | "jpg" => self.0.path().join(format!("with_{kind}.json")),
            "mtl" => self.0.path().join("with_mtl.obj"),
            _ => mutant,
        };
        let before = peak_memory();
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| check(entry.to_str().expect("UTF-8"))));
        let (time, growth) = (start.elapsed(), peak_memory().saturating_sub(before));
        outcome.map_err(|_| "panicked".to_string())??;
        if time > MAX_TIME {
            return Err(format!("took {time:?}"));
        }
        if growth > MAX_GROWTH {
            return Err(format!("took {growth} KiB"));
        }
        Ok(())
    }
}

/// Loads a scene and looks whether it is sound.
fn check(path: &str) -> Result<(), String> {
    match load(path, None) {
        Err(error) => {
            let message = error.to_string();
            let is_fine = !message.contains('\n') && message.len() < 4000;
            if is_fine { Ok(()) } else { Err(format!("says more than a sentence: {message}")) }
        }
        Ok(scene) => {
            if let Some(problem) = scene.problem() {
                return Err(problem);
            }
            for object in &scene.objects {
                object.mesh.validate()?;
            }
            for triangle in scene.world_triangles() {
                let sound = triangle.positions.iter().chain(&triangle.normals).all(|v| v.is_finite());
                if !sound || triangle.material as usize >= scene.materials.len() {
                    return Err(format!("unsound triangle {triangle:?}"));
                }
            }
            for material in &scene.materials {
                let total = material.k_d + material.k_s;
                let low = material.k_d.min(material.k_s).min_element();
                if !(low >= 0.0 && total.max_element() <= 1.0 + 1e-5 && material.exponent >= 0.0) {
                    return Err(format!("unsound material {material:?}"));
                }
            }
            match scene.notes.iter().find(|note| note.contains('\n') || note.len() > 4000) {
                Some(note) => Err(format!("a note of more than a sentence: {note}")),
                None => Ok(()),
            }
        }
    }
}

/// Highest memory use of this process so far \[KiB\]; 0 where it is not to be had.
fn peak_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|n| n.parse().ok()).unwrap_or(0)
}

/// Keeps an input that something was found with.
fn keep(name: &str, bytes: &[u8]) -> PathBuf {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus/found");
    let path = folder.join(format!("{:016x}-{name}", hasher.finish()));
    fs::create_dir_all(&folder).and_then(|()| fs::write(&path, bytes)).expect("the finding can be kept");
    path
}

/// What is being loaded, and since when.
type Current = Arc<Mutex<Option<(Instant, String, Vec<u8>)>>>;

/// Ends the process, keeping the input, if a load does not come back.
fn watch(current: Current) {
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let guard = current.lock().expect("not poisoned");
            if let Some((start, name, bytes)) = guard.as_ref()
                && start.elapsed() > 15 * MAX_TIME
            {
                eprintln!("hangs: {}", keep(name, bytes).display());
                std::process::exit(1);
            }
        }
    });
}

#[test]
fn what_was_found_before_is_mended() {
    let seeds = corpus("seeds");
    let bench = Bench::new(&seeds);
    for input in corpus("found").iter().chain(&seeds) {
        bench.run(&input.name, &input.bytes).unwrap_or_else(|what| panic!("{}: {what}", input.name));
    }
    for seed in &seeds {
        assert!(check(bench.0.path().join("scene.json").to_str().expect("UTF-8")).is_ok(), "{}", seed.name);
    }
}

#[test]
fn seeds_load_without_an_error() {
    let seeds = corpus("seeds");
    let bench = Bench::new(&seeds);
    for name in ["cube.obj", "patch.gltf", "patch.glb", "scene.json"] {
        let scene = load(bench.0.path().join(name).to_str().expect("UTF-8"), None).expect(name);
        assert!(scene.triangle_count() > 0, "{name}");
    }
}

#[test]
fn no_mutant_does_harm() {
    let asked: Option<u64> = std::env::var("FUZZ_SECONDS").ok().and_then(|seconds| seconds.parse().ok());
    let end = Instant::now() + Duration::from_secs(asked.unwrap_or(5));
    // The short run is the same at any time; each long one is another.
    let time = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos() as u64);
    let mut start = [0; 32];
    start[..8].copy_from_slice(&asked.map_or(0, |_| time).to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &start);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let mutations = proptest::collection::vec(mutation(), 1..6);

    let seeds = corpus("seeds");
    let bench = Bench::new(&seeds);
    let current = Current::default();
    watch(current.clone());
    let mut executions = 0u64;
    let mut findings = Vec::new();
    while Instant::now() < end && findings.len() < 20 {
        let seed = &seeds[executions as usize % seeds.len()];
        let mutations = mutations.new_tree(&mut runner).expect("a case").current();
        let mut bytes = seed.bytes.clone();
        mutations.iter().for_each(|mutation| mutate(&mut bytes, mutation, &seeds));
        *current.lock().expect("not poisoned") = Some((Instant::now(), seed.name.clone(), bytes.clone()));
        // A busy machine may have made a load late: time it twice.
        if bench.run(&seed.name, &bytes).is_err()
            && let Err(what) = bench.run(&seed.name, &bytes)
        {
            findings.push(format!("{}: {what}", keep(&seed.name, &bytes).display()));
        }
        *current.lock().expect("not poisoned") = None;
        executions += 1;
    }
    println!("{executions} mutants, {} findings, peak {} MiB", findings.len(), peak_memory() >> 10);
    assert!(findings.is_empty(), "{findings:#?}");
}
