fn main() -> std::process::ExitCode {
    resect::command::run()
}
