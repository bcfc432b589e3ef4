"""The case brain_slice with both codes: its geometry, contact and motion."""
