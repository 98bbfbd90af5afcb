//! What Penumbra promises, tested from outside: one binary, a module a subject.

#[cfg(test)]
mod adaptive;
#[cfg(test)]
mod analytic;
#[cfg(test)]
mod cli;
#[cfg(test)]
mod common;
#[cfg(test)]
mod corpus;
#[cfg(test)]
mod density;
#[cfg(test)]
mod features;
#[cfg(test)]
mod floors;
#[cfg(test)]
mod golden;
#[cfg(test)]
mod hostile;
#[cfg(test)]
mod noise;
#[cfg(test)]
mod oracle;
#[cfg(test)]
mod session;
