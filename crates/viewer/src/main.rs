//! rayview: the scene on the screen.

mod native;

fn main() -> std::process::ExitCode {
    native::main()
}
