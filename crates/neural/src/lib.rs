//! What the networks share on burn: double precision, affine-skip networks, Levenberg-Marquardt, safetensors.
