//! What the probe writes, on the host and on a board.
//!
//! ```text
//! call a1/f64/rnea            one call of an algorithm
//! cost 4d2 180                on a board: SysTick periods and stack bytes, hexadecimal
//! value 3ff0000000000000      bits of one number of the result
//! ```

use anyhow::{Context, Result, bail};

/// One call of an algorithm and what it returned.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Call {
    /// `subject/scalar/algorithm`.
    pub(crate) label: String,
    pub(crate) cost: Option<Cost>,
    pub(crate) values: Vec<u64>,
}

/// What a call cost on a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cost {
    /// SysTick periods.
    pub(crate) ticks: u32,
    /// Bytes below the caller's frame.
    pub(crate) stack: u32,
}

/// Reads the probe's lines.
pub(crate) fn parse(text: &str) -> Result<Vec<Call>> {
    let mut calls: Vec<Call> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        read(line, &mut calls).with_context(|| format!("line {}: {line:?}", number + 1))?;
    }
    Ok(calls)
}

fn read(line: &str, calls: &mut Vec<Call>) -> Result<()> {
    let (kind, rest) = line.split_once(' ').context("no blank")?;
    if kind == "call" {
        calls.push(Call {
            label: rest.into(),
            ..Call::default()
        });
        return Ok(());
    }
    let call = calls.last_mut().context("no call before it")?;
    match kind {
        "value" => call.values.push(u64::from_str_radix(rest, 16)?),
        "cost" => {
            let (ticks, stack) = rest.split_once(' ').context("no stack")?;
            let ticks = u32::from_str_radix(ticks, 16)?;
            call.cost = Some(Cost {
                ticks,
                stack: u32::from_str_radix(stack, 16)?,
            });
        }
        _ => bail!("unknown kind of line"),
    }
    Ok(())
}

/// The first difference between the results of two runs, or the number of equal values.
pub(crate) fn compare(host: &[Call], board: &[Call]) -> Result<usize> {
    let mut equal = 0;
    for (index, (a, b)) in host.iter().zip(board).enumerate() {
        if a.label != b.label {
            bail!(
                "call {index} is {} on the host, {} on the board",
                a.label,
                b.label
            );
        }
        let nth = host
            .iter()
            .take(index)
            .filter(|call| call.label == a.label)
            .count();
        let name = format!("{}, call {nth}", a.label);
        if a.values.len() != b.values.len() {
            bail!(
                "{name}: {} values on the host, {} on the board",
                a.values.len(),
                b.values.len()
            );
        }
        if let Some((place, (x, y))) = a
            .values
            .iter()
            .zip(&b.values)
            .enumerate()
            .find(|(_, (x, y))| x != y)
        {
            let (host, board) = (f64::from_bits(*x), f64::from_bits(*y));
            bail!(
                "{name}, value {place}: {host:e} ({x:016x}) on the host, {board:e} ({y:016x}) on the board"
            );
        }
        equal += a.values.len();
    }
    if host.len() != board.len() {
        bail!(
            "{} calls on the host, {} on the board",
            host.len(),
            board.len()
        );
    }
    if equal == 0 {
        bail!("nothing was compared");
    }
    Ok(equal)
}

#[cfg(test)]
mod tests {
    use super::{Call, compare, parse};

    const RUN: &str = "call a1/f64/rnea\ncost 10 20\nvalue 3ff0000000000000\nvalue 0\n\
                       call a1/f64/crba\nvalue 4000000000000000\n";

    fn parsed(text: &str) -> Vec<Call> {
        parse(text).unwrap_or_default()
    }

    #[test]
    fn equal_runs_agree_whatever_they_cost() {
        let cheap = RUN.replace("cost 10 20\n", "");
        assert_eq!(compare(&parsed(RUN), &parsed(&cheap)).ok(), Some(3));
    }

    #[test]
    fn one_bit_is_a_difference_with_its_name() {
        let other = RUN.replace("4000000000000000", "4000000000000001");
        let error = compare(&parsed(RUN), &parsed(&other))
            .err()
            .map(|e| e.to_string());
        assert!(error.is_some_and(|text| text.starts_with("a1/f64/crba, call 0, value 0: ")));
    }

    #[test]
    fn missing_calls_values_and_empty_runs_are_differences() {
        let short: String = RUN
            .lines()
            .take(4)
            .map(|line| format!("{line}\n"))
            .collect();
        assert!(compare(&parsed(RUN), &parsed(&short)).is_err());
        assert!(compare(&parsed(RUN), &parsed(&RUN.replace("value 0\n", ""))).is_err());
        assert!(compare(&[], &[]).is_err());
    }

    #[test]
    fn garbage_is_refused() {
        for text in [
            "value 0\n",
            "call a\nvalue x\n",
            "call a\ncost 1\n",
            "noise\n",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
