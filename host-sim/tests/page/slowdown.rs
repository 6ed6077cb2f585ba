//! Does an open page slow the plant?
