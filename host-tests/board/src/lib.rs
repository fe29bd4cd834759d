//! Tests of the firmware on the emulated board.
