// The kind of light that a pipeline is made for, so that a shader holds nothing that it does not need. Needs light.
// Twin of the overrides: Variant.

/// One of LIGHT_*.
override KIND: u32 = LIGHT_POINT;
/// Whether a light map tints a spot.
override HAS_MAP: bool = false;
/// Whether a spot's intensity falls off towards the edge of its cone.
override HAS_RAMP: bool = true;
