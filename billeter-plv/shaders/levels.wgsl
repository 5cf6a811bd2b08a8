// Min-max levels of a shadow map, after Tevs, Ihrke and Seidel 2008: a quadtree over its texels.
//
// A word of the finest level is a texel's reversed depth; 0 is empty. A word above holds the least and the
// greatest depth below it, in 16 bits each: the upper half of a float, rounded outwards, so that a block may be
// taken for mixed where it is not, but never the other way round.

/// Bits of depths not below zero order as the depths do.
fn pack_range(least: u32, most: u32) -> u32 {
    return (least >> 16u) | ((most + 0xffffu) & 0xffff0000u);
}
