//! Loops that may be written out.

/// A loop that is written out for a description known to the compiler, which then sees every turn by itself, and left
/// as it is for any other, where the compiler takes several turns at once. The body must not leave or skip a turn.
/// `many` writes out a loop over segments, `few` one inside another, of mostly up to four turns.
macro_rules! every {
    (many $unroll:expr, $rows:expr, $row:pat => $body:block) => {{
        let mut rows = $rows;
        if $unroll {
            loop {
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
            }
        } else {
            for $row in rows $body
        }
    }};
    (few $unroll:expr, $rows:expr, $row:pat => $body:block) => {{
        let mut rows = $rows;
        if $unroll {
            loop {
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
            }
        } else {
            for $row in rows $body
        }
    }};
    ($unroll:expr, $rows:expr, $row:pat => $body:block) => {{
        let mut rows = $rows;
        if $unroll {
            loop {
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
                every!(@turn rows, $row => $body);
            }
        } else {
            for $row in rows $body
        }
    }};
    (@turn $rows:ident, $row:pat => $body:block) => {
        let Some($row) = $rows.next() else { break };
        $body
    };
}

pub(crate) use every;
