//! The time of stages.

use std::time::Instant;

use crate::Stage;

/// Runs a stage and notes its time.
pub(crate) fn timed<T>(stages: &mut Vec<Stage>, name: &'static str, work: impl FnOnce() -> T) -> T {
    let (wall, cpu) = (Instant::now(), processor_seconds());
    let result = work();
    let cpu = processor_seconds().zip(cpu).map(|(end, start)| end - start);
    stages.push(Stage { name, wall: wall.elapsed().as_secs_f64(), cpu });
    result
}

#[cfg(unix)]
fn processor_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(not(unix))]
fn processor_seconds() -> Option<f64> {
    None
}
