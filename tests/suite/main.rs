//! What Penumbra promises, tested from outside: one binary, a module a subject.

#[cfg(test)]
mod cli;
#[cfg(test)]
mod floors;
#[cfg(test)]
mod hostile;
#[cfg(test)]
mod session;
