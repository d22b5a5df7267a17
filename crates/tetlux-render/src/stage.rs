//! The time each stage of a picture takes.

use std::time::Instant;

/// One stage.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// What was done.
    pub name: &'static str,
    /// Seconds by the clock.
    pub wall: f64,
    /// Seconds of processor time of the whole process, user and system, all threads; `None` where the system does
    /// not tell.
    pub cpu: Option<f64>,
}

/// Collects stages as they are run.
#[derive(Debug, Default)]
pub struct Stages(Vec<Stage>);

impl Stages {
    /// Runs a stage and notes its time, beside that of earlier runs under the same name.
    pub fn run<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        let (wall, cpu) = (Instant::now(), processor_seconds());
        let result = work();
        let cpu = processor_seconds().zip(cpu).map(|(end, start)| end - start);
        let wall = wall.elapsed().as_secs_f64();
        match self.0.iter_mut().find(|stage| stage.name == name) {
            Some(stage) => {
                stage.wall += wall;
                stage.cpu = stage.cpu.zip(cpu).map(|(before, now)| before + now);
            }
            None => self.0.push(Stage { name, wall, cpu }),
        }
        result
    }

    /// The stages so far.
    pub fn into_vec(self) -> Vec<Stage> {
        self.0
    }
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
