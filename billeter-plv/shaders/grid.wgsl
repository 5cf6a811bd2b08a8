// The grid that the adaptive mesh refines.

/// Cells on a side of the grid that the adaptive mesh refines: the power of two that holds the map.
fn grid_cells(shadow_size: f32) -> u32 {
    let cells = u32(shadow_size) - 1u;
    return select(1u << (32u - countLeadingZeros(cells - 1u)), 1u, cells <= 1u);
}
