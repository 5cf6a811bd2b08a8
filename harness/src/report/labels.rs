//! Where the words of a chart go, so that they cover nothing.

/// A rectangle \[SVG pixels\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub left: i32,
    pub top: i32,
    pub right: i32,
    pub bottom: i32,
}

impl Area {
    /// About a point.
    pub(crate) fn about((x, y): (i32, i32), reach: i32) -> Self {
        Self { left: x - reach, top: y - reach, right: x + reach, bottom: y + reach }
    }

    fn overlap(&self, other: &Self) -> i32 {
        let across = self.right.min(other.right) - self.left.max(other.left);
        let down = self.bottom.min(other.bottom) - self.top.max(other.top);
        across.max(0) * down.max(0)
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && self.right >= other.right
            && self.top <= other.top
            && self.bottom >= other.bottom
    }
}

/// What is taken already.
#[derive(Clone, Debug)]
pub(crate) struct Labels {
    within: Area,
    taken: Vec<Area>,
}

/// How far words keep from what they belong to, near places first \[SVG pixels\].
const DISTANCES: [i32; 4] = [9, 16, 26, 40];

impl Labels {
    pub(crate) fn new(within: Area) -> Self {
        Self { within, taken: Vec::new() }
    }

    /// Keeps words away from an area.
    pub(crate) fn block(&mut self, area: Area) {
        self.taken.push(area);
    }

    /// Keeps words away from a line.
    pub(crate) fn block_line(&mut self, from: (i32, i32), to: (i32, i32)) {
        let (across, down) = (to.0 - from.0, to.1 - from.1);
        let steps = (across.abs().max(down.abs()) / 5).max(1);
        for step in 0..=steps {
            self.block(Area::about((from.0 + across * step / steps, from.1 + down * step / steps), 2));
        }
    }

    /// Where words of `size` are best put: upper left corner, near one of `anchors`; and takes the place. `None`
    /// where they would cover something and `must` is not said.
    pub(crate) fn place(
        &mut self,
        anchors: &[(i32, i32)],
        size: (i32, i32),
        must: bool,
    ) -> Option<(i32, i32)> {
        let (width, height) = size;
        let mut best: Option<(i32, Area)> = None;
        // Words that need not be there are clearer left out than far away.
        let reach = if must { DISTANCES.len() } else { 2 };
        for distance in DISTANCES.into_iter().take(reach) {
            for (x, y) in anchors {
                let (right, left) = (x + distance, x - distance - width);
                let (above, below) = (y - distance - height + 4, y + distance - 4);
                let (beside, over) = (y - height / 2, x - width / 2);
                for (left, top) in [
                    (right, beside),
                    (right, above),
                    (right, below),
                    (left, beside),
                    (left, above),
                    (left, below),
                    (over, above),
                    (over, below),
                ] {
                    let area = Area { left, top, right: left + width, bottom: top + height };
                    if !self.within.holds(&area) {
                        continue;
                    }
                    let cost = self.taken.iter().map(|other| area.overlap(other)).sum();
                    if best.is_none_or(|(least, _)| cost < least) {
                        best = Some((cost, area));
                    }
                }
            }
            if best.is_some_and(|(cost, _)| cost == 0) {
                break;
            }
        }
        let (_, area) = best.filter(|(cost, _)| must || *cost == 0)?;
        self.block(area);
        Some((area.left, area.top))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_cover_neither_each_other_nor_a_line() {
        let mut labels = Labels::new(Area { left: 0, top: 0, right: 400, bottom: 300 });
        labels.block_line((0, 150), (400, 150));
        let size = (60, 16);
        let mut placed: Vec<Area> = Vec::new();
        for _ in 0..6 {
            let (left, top) = labels.place(&[(200, 150)], size, true).unwrap();
            let area = Area { left, top, right: left + size.0, bottom: top + size.1 };
            assert!(area.bottom <= 150 || area.top >= 150, "{area:?}");
            assert!(placed.iter().all(|other| other.overlap(&area) == 0), "{area:?} {placed:?}");
            placed.push(area);
        }
        // Nothing is left near a corner that is blocked.
        labels.block(Area { left: 0, top: 0, right: 120, bottom: 120 });
        assert_eq!(labels.place(&[(10, 10)], size, false), None);
        assert!(labels.place(&[(10, 10)], size, true).is_some());
    }
}
