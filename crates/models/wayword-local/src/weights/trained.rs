//! A checkpoint as training leaves it: an archive with a pickle, of which the weights under `model` alone are read.

use super::pickle::Pickle;
use crate::{LocalError, error::FETCH_AGAIN};
use candle_core::{DType, Device, Tensor};
use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, BufReader, Read},
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};
use zip::{CompressionMethod, ZipArchive};

/// The table of the weights.
const WEIGHTS: &str = "model";

/// What the names of the weights begin with, if they were trained on several devices.
const BEGIN: &str = "module.";

/// Longest pickle, bytes. It has no numbers of tensors.
const LONGEST_PICKLE: u64 = 32 << 20;

/// An open archive, and where its weights lie.
pub(super) struct Trained {
    path: PathBuf,
    archive: Mutex<ZipArchive<BufReader<File>>>,
    /// The folder of the archive.
    root: String,
    tensors: BTreeMap<String, Lies>,
    length: u64,
}

/// Where a tensor lies: numbers of an entry of the archive.
struct Lies {
    entry: String,
    dtype: DType,
    /// Numbers of the entry, and those before the tensor.
    count: u64,
    offset: u64,
    shape: Vec<usize>,
    strides: Vec<usize>,
}

impl Trained {
    pub(super) fn open(path: &Path) -> Result<Self, LocalError> {
        let io = |error| LocalError::io(path, "read", error);
        let damaged = |problem: String| LocalError::File {
            file: path.to_owned(),
            problem: format!("it is cut off or not a checkpoint of PyTorch: {problem}"),
            hint: FETCH_AGAIN,
        };
        let file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let mut archive = ZipArchive::new(BufReader::new(file)).map_err(|error| damaged(error.to_string()))?;
        let is_pickle = |name: &&str| name.split_once('/').is_some_and(|(_, file)| file == "data.pkl");
        let names: Vec<String> = archive.file_names().filter_map(|name| Some(name.ok()?.into_owned())).collect();
        let pickle = names.iter().map(String::as_str).find(is_pickle);
        let root = pickle.and_then(|name| name.split_once('/')).map(|(root, _)| root.to_owned());
        let root = root.ok_or_else(|| damaged("it has no data.pkl".to_owned()))?;
        let bytes = entry(&mut archive, &format!("{root}/data.pkl"), |entry| {
            if entry.size > LONGEST_PICKLE {
                return Err(format!("its pickle has {} bytes", entry.size));
            }
            let mut bytes = Vec::new();
            entry.read.read_to_end(&mut bytes).map_err(|error| error.to_string())?;
            Ok(bytes)
        });
        let pickle = Pickle::read(&bytes.map_err(damaged)?).map_err(damaged)?;
        let tensors = pickle.tensors(WEIGHTS).map_err(damaged)?.map(|(name, place)| {
            let lies = Lies {
                entry: place.storage.key.to_string(),
                dtype: if place.storage.floats { DType::F32 } else { DType::I64 },
                count: place.storage.count,
                offset: place.offset,
                shape: place.shape.clone(),
                strides: place.strides.clone(),
            };
            (name.strip_prefix(BEGIN).unwrap_or(&name).to_owned(), lies)
        });
        let tensors = tensors.collect();
        Ok(Self { path: path.to_owned(), archive: Mutex::new(archive), root, tensors, length })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        self.tensors.keys().cloned()
    }

    pub(super) fn shape(&self, name: &str) -> Option<Vec<usize>> {
        Some(self.tensors.get(name)?.shape.clone())
    }

    /// Reads a tensor, and checks its shape.
    pub(super) fn read(&self, name: &str, shape: &[usize]) -> Result<Tensor, LocalError> {
        let wrong = |problem: String| LocalError::tensor(&self.path, name, problem);
        let lies = self.tensors.get(name).ok_or_else(|| wrong("it is missing".to_owned()))?;
        if lies.shape != shape {
            return Err(wrong(format!("its shape is {:?}, not {shape:?}", lies.shape)));
        }
        let bytes = lies.range(self.length).and_then(|range| self.bytes(lies, range)).map_err(wrong)?;
        Tensor::from_raw_buffer(&bytes, lies.dtype, shape, &Device::Cpu).map_err(|error| wrong(error.to_string()))
    }

    fn bytes(&self, lies: &Lies, (from, length): (u64, u64)) -> Result<Vec<u8>, String> {
        let mut archive = self.archive.lock().unwrap_or_else(PoisonError::into_inner);
        entry(&mut archive, &format!("{}/data/{}", self.root, lies.entry), |entry| {
            let whole = lies.count * lies.dtype.size_in_bytes() as u64;
            if entry.size != whole {
                return Err(format!("its entry of the archive has {} bytes, not {whole}", entry.size));
            }
            let mut read = entry.read;
            let told = |error: io::Error| error.to_string();
            io::copy(&mut Read::take(&mut read, from), &mut io::sink()).map_err(told)?;
            // The length was checked against that of the file.
            let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
            Read::take(&mut read, length).read_to_end(&mut bytes).map_err(told)?;
            // At the end of an entry its checksum is compared.
            let more = if from + length == whole { io::copy(&mut read, &mut io::sink()).map_err(told)? } else { 0 };
            if bytes.len() as u64 == length && more == 0 { Ok(bytes) } else { Err("it is cut off".to_owned()) }
        })
    }
}

impl Lies {
    /// The bytes of the entry that are the tensor's: where they begin, and how many they are.
    fn range(&self, file: u64) -> Result<(u64, u64), String> {
        let numbers = self.shape.iter().try_fold(1_u64, |product, &length| product.checked_mul(length as u64));
        let size = self.dtype.size_in_bytes() as u64;
        let end = numbers.and_then(|numbers| self.offset.checked_add(numbers)).filter(|end| *end <= self.count);
        let whole = self.count.checked_mul(size).filter(|whole| *whole <= file);
        let (Some(numbers), Some(_), Some(_)) = (numbers, end, whole) else {
            return Err(format!("it is larger than what the file of {file} bytes has of it"));
        };
        let mut step = 1;
        for (&length, &stride) in self.shape.iter().zip(&self.strides).rev() {
            if length > 1 && stride != step {
                return Err(format!(
                    "its numbers do not lie in order: shape {:?}, strides {:?}",
                    self.shape, self.strides
                ));
            }
            step *= length.max(1);
        }
        Ok((self.offset * size, numbers * size))
    }
}

/// An entry of an archive.
struct Entry<'a> {
    size: u64,
    read: &'a mut dyn Read,
}

/// Calls `then` with an entry that is not compressed: PyTorch compresses none, and so none can be larger than the file.
fn entry<T>(
    archive: &mut ZipArchive<BufReader<File>>,
    name: &str,
    then: impl FnOnce(Entry<'_>) -> Result<T, String>,
) -> Result<T, String> {
    let mut found = archive.by_name(name).map_err(|error| format!("{name}: {error}"))?;
    if found.compression() != CompressionMethod::Stored || found.compressed_size() != found.size() {
        return Err(format!("{name} is compressed"));
    }
    then(Entry { size: found.size(), read: &mut found })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use zip::{ZipWriter, write::SimpleFileOptions};

    fn fixture() -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/glip/glip.pth")
    }

    /// An archive with this pickle, and the storage `0` of 16 bytes.
    fn made(folder: &Path, pickle: &[u8]) -> PathBuf {
        let path = folder.join("made.pth");
        let mut archive = ZipWriter::new(File::create(&path).unwrap());
        let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        for (name, bytes) in
            [("a/data.pkl", pickle), ("a/data/0", &[0, 0, 128, 63, 0, 0, 0, 64, 0, 0, 64, 64, 0, 0, 128, 64])]
        {
            archive.start_file(name, stored).unwrap();
            archive.write_all(bytes).unwrap();
        }
        archive.finish().unwrap();
        path
    }

    /// A pickle of {"model": {"module.w": tensor}} with these numbers: of the storage, before the tensor, shape, stride.
    fn pickle(count: u8, offset: u8, shape: &[u8], strides: &[u8]) -> Vec<u8> {
        let text = |text: &str| [&[b'X', text.len() as u8, 0, 0, 0][..], text.as_bytes()].concat();
        let tuple =
            |numbers: &[u8]| [&[b'('][..], &numbers.iter().flat_map(|&n| [b'K', n]).collect::<Vec<_>>(), b"t"].concat();
        let storage = [
            b"(".to_vec(),
            text("storage"),
            b"ctorch\nFloatStorage\n".to_vec(),
            text("0"),
            text("cpu"),
            vec![b'K', count],
            b"tQ".to_vec(),
        ]
        .concat();
        let tensor = [
            b"ctorch._utils\n_rebuild_tensor_v2\n(".to_vec(),
            storage,
            vec![b'K', offset],
            tuple(shape),
            tuple(strides),
            b"\x89ccollections\nOrderedDict\n)RtR".to_vec(),
        ]
        .concat();
        [b"\x80\x02}".to_vec(), text("model"), b"}".to_vec(), text("module.w"), tensor, b"ss.".to_vec()].concat()
    }

    fn told(folder: &Path, pickle: &[u8], shape: &[usize]) -> Result<Vec<f32>, String> {
        let file = Trained::open(&made(folder, pickle)).map_err(|error| error.to_string())?;
        let tensor = file.read("w", shape).map_err(|error| error.to_string())?;
        Ok(tensor.flatten_all().unwrap().to_vec1().unwrap())
    }

    #[test]
    fn the_weights_alone_are_read() {
        let file = Trained::open(&fixture()).unwrap();
        assert!(file.names().all(|name| !name.starts_with("module.") && !name.contains("exp_avg")));
        assert_eq!(file.shape("rpn.head.bias0").unwrap(), [1]);
        let bias = file.read("rpn.head.bias0", &[1]).unwrap().to_vec1::<f32>().unwrap()[0];
        assert!((-1.5..-0.5).contains(&bias), "{bias}");
        let index = "backbone.body.layers.0.blocks.0.attn.relative_position_index";
        assert_eq!(file.read(index, &[9, 9]).unwrap().to_vec2::<i64>().unwrap()[8][8], 80);
        let error = file.read("rpn.head.bias0", &[2]).unwrap_err().to_string();
        assert!(
            error.contains("glip.pth") && error.contains("rpn.head.bias0") && error.contains("[1], not [2]"),
            "{error}"
        );
    }

    #[test]
    fn a_tensor_may_be_a_part_of_its_storage() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(told(folder.path(), &pickle(4, 0, &[2, 2], &[2, 1]), &[2, 2]).unwrap(), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(told(folder.path(), &pickle(4, 1, &[2, 1], &[1, 7]), &[2, 1]).unwrap(), [2.0, 3.0]);
    }

    #[test]
    fn what_does_not_fit_together_is_told_by_tensor() {
        let folder = tempfile::tempdir().unwrap();
        for (pickle, shape, problem) in [
            (pickle(4, 3, &[2], &[1]), &[2][..], "larger than"),
            (pickle(5, 0, &[5], &[1]), &[5], "16 bytes, not 20"),
            (pickle(255, 0, &[255], &[1]), &[255], "larger than"),
            (pickle(4, 0, &[2, 2], &[1, 2]), &[2, 2], "in order"),
        ] {
            let error = told(folder.path(), &pickle, shape).unwrap_err();
            assert!(error.contains("made.pth") && error.contains("tensor w") && error.contains(problem), "{error}");
        }
    }

    #[test]
    fn nothing_is_called_that_is_not_known() {
        let folder = tempfile::tempdir().unwrap();
        for (pickle, problem) in [
            (&b"cos\nsystem\n(X\x04\x00\x00\x00true\x85R."[..], "\"os.system\""),
            (b"ctorch\nHalfStorage\n.", "torch.HalfStorage"),
            (b"\x80\x04\x8c\x01a.", "0x8c"),
            (b"ccollections\nOrderedDict\n(K\x01tR.", "to be called"),
            (b"}.", "no table \"model\""),
            (b"K\x01.", "not hold a table"),
            (b"h\x07.", "not kept"),
            (b"}X\xff\xff\xff\xff", "cut off"),
            (b"(", "cut off"),
            (b"R", "not there"),
            (b"(K\x01u", "no table"),
            (b"", "cut off"),
            (&[&[b'N'][..], &[0x85; 100_000]].concat(), "deeper than 16"),
        ] {
            let error = told(folder.path(), pickle, &[1]).unwrap_err();
            assert!(error.contains("made.pth") && error.contains(problem), "{problem}: {error}");
        }
    }

    #[test]
    fn a_file_that_is_cut_off_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (whole, path) = (std::fs::read(fixture()).unwrap(), folder.path().join("cut.pth"));
        for length in [0, 30, whole.len() / 2, whole.len() - 1] {
            std::fs::write(&path, &whole[..length]).unwrap();
            let error = Trained::open(&path).err().expect("it is refused").to_string();
            assert!(error.contains("cut.pth") && error.contains("cut off"), "{error}");
        }
        // A number of a tensor that was changed is found by its checksum.
        let mut changed = whole;
        let name = b"/data/0";
        let at = changed.windows(name.len()).position(|window| window == name).unwrap() + 200;
        changed[at] ^= 0x40;
        std::fs::write(&path, &changed).unwrap();
        let file = Trained::open(&path).unwrap();
        let problems = file.names().filter(|name| file.read(name, &file.shape(name).unwrap()).is_err()).count();
        assert_eq!(problems, 1);
    }
}
