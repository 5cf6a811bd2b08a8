//! A run's folder: filled beside its place and put there when it is whole.

use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

use common::files::write_whole;

use crate::failure::Failure;
use crate::record::RECORDS;

/// A folder that a run fills. Until [`RunFolder::finish`] the earlier results stay as they are; a run
/// that ends early leaves what it has under another name, or nothing where it has no record.
pub(crate) struct RunFolder {
    destination: PathBuf,
    partial: PathBuf,
    /// Held as long as the run goes on, whatever ends it. None where the file system knows no locks.
    lock: Option<File>,
}

/// File in an unfinished folder that its run holds locked.
const LOCK: &str = "run.lock";

impl RunFolder {
    /// A new folder beside `destination`, which need not exist. Fails where nothing can be written.
    pub(crate) fn create(destination: &Path) -> Result<Self, Failure> {
        let unusable = |what: &dyn std::fmt::Display| unusable(destination, what);
        let (parent, prefix) = place(destination)?;
        check_replaceable(destination, &[RECORDS])?;
        std::fs::create_dir_all(parent).map_err(|error| unusable(&error))?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // As any newly made folder; the umask still applies.
            builder.permissions(std::fs::Permissions::from_mode(0o777));
        }
        let partial = builder.tempdir_in(parent).map_err(|error| unusable(&error))?.keep();
        Self::lock(destination, partial)
    }

    /// The newest folder that a run into `destination` left when it was stopped.
    pub(crate) fn resume(destination: &Path) -> Result<Self, Failure> {
        check_replaceable(destination, &[RECORDS])?;
        let (parent, prefix) = place(destination)?;
        let prefix = prefix.to_string_lossy().into_owned();
        let left = parent.read_dir().into_iter().flatten().filter_map(Result::ok);
        let left = left.filter(|entry| entry.file_name().to_string_lossy().starts_with(&prefix));
        // By its records: a folder's own time does not move when they grow.
        let with_records = left.filter_map(|entry| {
            let about = entry.path().join(RECORDS).metadata().ok().filter(|about| about.len() > 0)?;
            Some((about.modified().ok(), entry.path()))
        });
        let Some((_, newest)) = with_records.max() else {
            return Err(Failure::Input(format!(
                "there is no run into {} that was stopped; start one without --resume",
                destination.display()
            )));
        };
        Self::lock(destination, newest)
    }

    /// Takes a folder for this run alone.
    fn lock(destination: &Path, partial: PathBuf) -> Result<Self, Failure> {
        let file = File::create(partial.join(LOCK)).map_err(|error| unusable(&partial, &error))?;
        let lock = match file.try_lock() {
            Ok(()) => Some(file),
            Err(TryLockError::Error(_)) => None,
            Err(TryLockError::WouldBlock) => {
                return Err(Failure::Input(format!(
                    "another run into {} is still going on, in {}; wait for its end or stop it",
                    destination.display(),
                    partial.display()
                )));
            }
        };
        Ok(Self { destination: destination.into(), partial, lock })
    }

    /// Where to write until the run is finished.
    pub(crate) fn path(&self) -> &Path {
        &self.partial
    }

    /// Puts the folder in the place of the earlier results.
    pub(crate) fn finish(self) -> Result<PathBuf, Failure> {
        if let Err(failure) = check_replaceable(&self.destination, &[RECORDS]) {
            return Err(failure.also(&format!("the results are in {}", self.partial.display())));
        }
        let partial = self.partial;
        // Where open files can't be removed, it has to be closed first.
        drop(self.lock);
        drop(std::fs::remove_file(partial.join(LOCK)));
        let failed = |error: std::io::Error| {
            Failure::Run(format!(
                "can't put the results into {}: {error}; they are in {}",
                self.destination.display(),
                partial.display()
            ))
        };
        if self.destination.exists() {
            // Aside, not away, until the new ones are in place.
            let parent = self.destination.parent().filter(|p| !p.as_os_str().is_empty());
            let aside =
                tempfile::Builder::new().prefix("replaced-").tempdir_in(parent.unwrap_or(Path::new(".")));
            // Kept whatever happens: it is where the earlier results are if neither can be put in place.
            let aside = aside.map_err(failed)?.keep();
            let old = aside.join("results");
            std::fs::rename(&self.destination, &old).map_err(failed)?;
            if let Err(error) = std::fs::rename(&partial, &self.destination) {
                if std::fs::rename(&old, &self.destination).is_ok() {
                    drop(std::fs::remove_dir(aside));
                    return Err(failed(error));
                }
                return Err(failed(error).also(&format!("the earlier ones are in {}", old.display())));
            }
            // What can't be removed does no harm.
            drop(std::fs::remove_dir_all(aside));
        } else {
            std::fs::rename(&partial, &self.destination).map_err(failed)?;
        }
        Ok(self.destination)
    }

    /// Ends a run that failed: keeps the folder if it holds a record, and says where.
    pub(crate) fn abandon(self, failure: Failure) -> Failure {
        let records = self.partial.join(RECORDS);
        if records.metadata().is_ok_and(|metadata| metadata.len() > 0) {
            let kept = self.partial.display();
            return failure
                .also(&format!("the records taken so far are in {kept}; --resume goes on with them"));
        }
        self.discard();
        failure
    }

    /// Ends a run that has nothing to keep.
    pub(crate) fn discard(self) {
        drop(self.lock);
        // What can't be removed does no harm.
        drop(std::fs::remove_dir_all(&self.partial));
    }
}

/// Never take away what this program has not put there: one of the `marks` is in every folder that it fills.
pub(crate) fn check_replaceable(destination: &Path, marks: &[&str]) -> Result<(), Failure> {
    if !destination.exists() {
        return Ok(());
    }
    if !destination.is_dir() {
        return Err(unusable(destination, &"it is a file"));
    }
    let empty = destination.read_dir().is_ok_and(|mut entries| entries.next().is_none());
    if empty || marks.iter().any(|mark| destination.join(mark).is_file()) {
        return Ok(());
    }
    Err(unusable(
        destination,
        &format_args!(
            "it is a folder that holds other things (no {}); expected a new folder or earlier results",
            marks.first().unwrap_or(&"results")
        ),
    ))
}

/// Makes the folder where there is none, and finds out whether files can be written there.
pub(crate) fn make_writable(folder: &Path) -> Result<(), Failure> {
    let made = std::fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder));
    made.map(drop).map_err(|error| unusable(folder, &error))
}

fn unusable(destination: &Path, what: &dyn std::fmt::Display) -> Failure {
    Failure::Input(format!("can't write results to {}: {what}", destination.display()))
}

/// The folder that `destination` is in, and what the names of unfinished ones begin with.
fn place(destination: &Path) -> Result<(&Path, std::ffi::OsString), Failure> {
    let name = destination.file_name().ok_or_else(|| unusable(destination, &"it names no folder"))?;
    let parent = destination.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut prefix = name.to_os_string();
    prefix.push(".partial-");
    Ok((parent, prefix))
}

/// Writes a text into a folder, whole or not at all.
pub(crate) fn write_text(folder: &Path, name: &str, text: &str) -> Result<(), Failure> {
    let path = folder.join(name);
    write_whole(&path, |file| file.write_all(text.as_bytes()))
        .map_err(|error: std::io::Error| Failure::Run(format!("can't write {}: {error}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn earlier_results_stay_until_the_new_ones_are_whole() {
        let place = tempfile::tempdir().unwrap();
        let destination = place.path().join("results/latest");
        let write =
            |folder: &RunFolder, text: &str| std::fs::write(folder.path().join(RECORDS), text).unwrap();
        let content = || std::fs::read_to_string(destination.join(RECORDS)).unwrap();

        let first = RunFolder::create(&destination).unwrap();
        write(&first, "first");
        first.finish().unwrap();
        assert_eq!(content(), "first");
        assert!(!destination.join(LOCK).exists());

        let stopped = RunFolder::create(&destination).unwrap();
        write(&stopped, "stopped");
        assert_eq!(content(), "first");
        let failure = stopped.abandon(Failure::Interrupted("stopped".into()));
        assert_eq!(failure.exit_code(), 130);
        let kept = failure.to_string();
        let kept = kept.rsplit(" in ").next().unwrap().split(';').next().unwrap();
        let kept = Path::new(kept);
        assert_eq!(std::fs::read_to_string(kept.join(RECORDS)).unwrap(), "stopped");
        assert_eq!(content(), "first");
        // One that ended before its first record is passed over.
        let killed = RunFolder::create(&destination).unwrap();
        let resumed = RunFolder::resume(&destination).unwrap();
        assert_eq!(resumed.path(), kept);
        // One that goes on is left alone.
        let failure = RunFolder::resume(&destination).err().unwrap();
        assert!(failure.exit_code() == 2 && failure.to_string().contains("still going on"), "{failure}");
        drop(resumed);
        drop(RunFolder::resume(&destination).unwrap());
        std::fs::remove_dir_all(killed.path()).unwrap();
        std::fs::remove_dir_all(kept).unwrap();
        assert_eq!(RunFolder::resume(&destination).err().unwrap().exit_code(), 2);

        let empty = RunFolder::create(&destination).unwrap();
        empty.abandon(Failure::Run("nothing measured".into()));
        let second = RunFolder::create(&destination).unwrap();
        write(&second, "second");
        second.finish().unwrap();
        assert_eq!(content(), "second");
        let left: Vec<_> = destination.parent().unwrap().read_dir().unwrap().collect();
        assert_eq!(left.len(), 1, "{left:?}");
    }

    #[test]
    fn a_folder_of_other_things_is_never_replaced() {
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join("thesis.txt"), "years of work").unwrap();
        let failure = RunFolder::create(place.path()).err().unwrap();
        assert_eq!(failure.exit_code(), 2);
        assert!(place.path().join("thesis.txt").exists());
    }
}
