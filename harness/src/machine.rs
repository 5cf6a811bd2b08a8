//! Which machine, which commit, which day.

use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

/// The machine that a measurement was taken on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Machine {
    /// Processor, as it calls itself.
    pub cpu: String,
    /// Logical cores that this process may use.
    pub cores: usize,
    /// Operating system and architecture.
    pub os: String,
}

impl Machine {
    /// This machine.
    pub(crate) fn this() -> Self {
        let field = |file: &str, key: &str, separator: char| {
            let text = std::fs::read_to_string(file).ok()?;
            let line = text.lines().find(|line| line.starts_with(key))?;
            Some(line.split_once(separator)?.1.trim().trim_matches('"').to_owned())
        };
        let arch = std::env::consts::ARCH;
        let os = field("/etc/os-release", "PRETTY_NAME", '=').unwrap_or(std::env::consts::OS.into());
        Self {
            cpu: field("/proc/cpuinfo", "model name", ':').unwrap_or_else(|| arch.into()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            os: format!("{os}, {arch}"),
        }
    }
}

/// The commit that this program was built from: its short hash, with `+` where the checkout had
/// changes; `unknown` where there was no git or no checkout.
pub(crate) fn commit() -> String {
    env!("HARNESS_COMMIT").into()
}

/// Now, in UTC, as `2025-01-31T12:00:00Z`.
pub(crate) fn now() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (year, month, day) = date_of_day((seconds / 86_400) as i64);
    let of_day = seconds % 86_400;
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Year, month and day (from 1) of a day counted from 1970-01-01, at or after it.
fn date_of_day(mut day: i64) -> (i64, u32, i64) {
    let leap = |year: i64| (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    let mut year = 1970;
    while day >= 365 + i64::from(leap(year)) {
        day -= 365 + i64::from(leap(year));
        year += 1;
    }
    let february = 28 + i64::from(leap(year));
    let mut month = 1;
    for days in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if day < days {
            break;
        }
        day -= days;
        month += 1;
    }
    (year, month, day + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_become_dates() {
        for (day, date) in
            [(0, (1970, 1, 1)), (11_016, (2000, 2, 29)), (11_017, (2000, 3, 1)), (20_453, (2025, 12, 31))]
        {
            assert_eq!(date_of_day(day), date);
        }
    }
}
