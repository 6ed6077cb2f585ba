//! A Linux computer.
