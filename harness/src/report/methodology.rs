//! What the page says about how it was measured, and whom that favours.

/// A heading and what it says.
pub(crate) type Note = (&'static str, &'static str);

/// How the figures come about.
pub(crate) const METHODOLOGY: &[Note] = &[
    (
        "What is timed",
        "The technique's own passes, by timestamps of the device where it has them, else by wall clock. Shadow maps, \
         depth and lit surfaces, which every technique is given alike, are shown beside it as the ground.",
    ),
    (
        "What moves",
        "Everything, while times are taken: the scene's own motion at 30 frames a second, or, where it has none, camera \
         and lights on small circles. A frame that stands still hides what is made anew in each.",
    ),
    (
        "Warm-up and frames",
        "Frames before the timed ones are drawn and forgotten; how many of both is in every record and at the head of \
         this page. Times are medians; p95 is the nearest rank, so of fewer than twenty frames it is the largest. Within the time of so many steps is within \
         their median and spread.",
    ),
    (
        "Spread and equality",
        "The spread of a time is half of what lies between its median and its 95th percentile. Two times are equal where \
         they differ by no more than the sum of their spreads. Two errors are equal where they differ by no more than the \
         larger uncertainty of their references.",
    ),
    (
        "Dominated",
        "A setting is dominated, and drawn hollow, where another one, of anyone, is faster or better beyond the noise and in \
         neither worse beyond it. The frontier is what none dominates, as far as each is less wrong than all that are faster.",
    ),
    (
        "Errors",
        "Linear radiance of the airlight at time 0 against a CPU reference of the same terms, which marches nothing: lit \
         intervals by bisection, each integrated in double precision. An error at or below the reference's own uncertainty is \
         drawn as a bound. Of a cloud the reference are paths, two pictures of them, so that their noise cancels from RMSE \
         and bias; it is in the other errors.",
    ),
    (
        "Edges",
        "A rasteriser rounds corners to a fraction of a pixel, so at an edge the depth buffer that all techniques are given \
         may hold another surface than the ray through the pixel's centre meets. The reference's airlight goes up to what \
         the buffer holds there, a handful of pixels a picture (reference.other_surface in the records), which otherwise \
         are nearly all of the error below 0.2 %.",
    ),
    (
        "Equal error, equal time",
        "The cheapest of the settings that were measured; nothing is interpolated. Uniform marching alone is extrapolated \
         beyond its largest number of steps: error = c · N^−p, fitted where it still falls by at least 15 % from one \
         number of steps to the next, and time linear in N. Where its error has stopped falling, the least of what follows is \
         its floor, and what lies below is “never”. An extrapolation that has met no floor flatters marching.",
    ),
    (
        "Exponents",
        "Lines through the logarithms, by least squares; R² beside each. Below about 0.9 the exponent says little.",
    ),
    (
        "The reference's cache",
        "Reference pictures are kept by a hash of all that determines them, and read again; times are never kept.",
    ),
    (
        "The machine",
        "Nothing else should run. Where something does, times scatter: the spread shows it, and differences within it are \
         called equal. Figures of different machines or adapters are never in one chart.",
    ),
];

/// Whom the choices favour.
pub(crate) const BIAS: &[Note] = &[
    (
        "One author",
        "Who wrote the techniques wrote the peers. The peers are meant to be as good as we know how to make them, and both \
         uniform and equi-angular marching are given every number of steps; but nobody else has tuned them.",
    ),
    (
        "A software adapter is no GPU",
        "Filling large overlapping triangles and blending, which light volumes, shadow planes and sampling planes live on, is \
         done there by the same cores as arithmetic: it costs far more beside arithmetic than on a GPU, while fetches from \
         a shadow map, which marching lives on, come from a large cache. So it favours marching and other peers \
         that compute, and it is against whatever draws meshes.",
    ),
    (
        "Shadow maps are not counted",
        "They are part of the ground. That favours all who need them against biri-ss, which needs none; the charts of \
         total time show both.",
    ),
    (
        "Silhouettes are counted beside",
        "biri-ss finds silhouettes and sorts on the CPU. That time is in the column “CPU”, not in the technique's time: on \
         a device that waits for the CPU the frame is longer than the chart says.",
    ),
    (
        "No history",
        "Froxels and noisy offsets are commonly cured by reprojecting earlier frames. Single frames are compared here, so \
         that cure counts for nothing; nor does the ghosting that comes with it.",
    ),
    (
        "Noise counts as error",
        "An offset by pixel turns bands into noise, which a temporal filter would hide. RMSE counts it in full; FLIP and the \
         eye are kinder to it.",
    ),
    (
        "Single scattering",
        "Errors on the charts are against a reference of the same terms. What a technique's model leaves out is in the table \
         of model errors, and nowhere else.",
    ),
    (
        "One view, one moment",
        "Errors are of time 0 and of one camera for each scene; times are of the motion after it.",
    ),
    (
        "Shadow maps bound the error",
        "Whoever looks up a shadow map can't be more right than its texels, whatever it spends. Where several sizes were \
         measured, each is a point of its own, and its larger cost is in the ground.",
    ),
    (
        "Scenes",
        "The built-in scenes were made to show what the papers show: few lights, hard shadows, thin air. Many lights, dense \
         media and foliage would favour froxels and marching.",
    ),
    (
        "Presets",
        "The paper's setting is our implementation of what the paper prints, formulas put right; its authors may have done \
         better than they wrote.",
    ),
];

/// What the columns mean.
pub(crate) const DEFINITIONS: &[Note] = &[
    ("ms", "Median time per frame of the technique's own passes, unless another is named."),
    (
        "÷ 64 steps",
        "That time over the one of a uniform march of 64 steps of the same picture, with the same maps if that was measured.",
    ),
    (
        "÷ unshadowed",
        "That time over the one of the airlight without shadows: about the least that fog can cost.",
    ),
    (
        "rel. RMSE, bias, p99, max error",
        "Error of the airlight where the reference is lit, relative to its mean there: root of the mean squared error, mean \
         signed error (above 0: too bright), 99th percentile and largest absolute error of all pixels.",
    ),
    (
        "worst tile, leak",
        "Largest RMS error of any tile of 64 × 64 pixels; RMS of the light where the reference has none. Both relative \
         to the same mean.",
    ),
    (
        "FLIP",
        "Mean of the FLIP difference evaluator (Andersson et al. 2020), 0 to 1, on tone-mapped pictures of reference surfaces \
         with this airlight against the same with the reference's, 67 pixels per degree.",
    ),
    ("energy", "Sum of the airlight over the reference's sum."),
    ("NaN, inf, neg.", "Pixels that are not a number, infinite, negative. Anything but 0 fails the run."),
    (
        "pictures",
        "Surfaces and airlight, exposure from the reference, tone curve 1 − exp(−x), sRGB; in this page at most 640 pixels \
         wide, without loss where they fit, else as JPEG. The false-colour difference is the largest of the three channels, \
         in codes of 255, on a logarithmic scale. It holds more than the errors above: edges of surfaces, which the \
         rasteriser and the reference's rays see a pixel apart, and up to about 4 codes of the JPEG's.",
    ),
];
