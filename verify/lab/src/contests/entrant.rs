//! A program that takes part: its name and the words of its command.

use std::path::Path;
use std::str::FromStr;

/// Stands for the path of the job in a command.
const JOB: &str = "{job}";
/// Stands for the path of the answer.
const ANSWER: &str = "{answer}";

/// A program that solves jobs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entrant {
    /// In tables.
    pub name: String,
    /// The program and its arguments, with placeholders for the two files.
    pub command: Vec<String>,
    /// The command for reports.
    pub shown: String,
}

/// What a name must be, since folders and pages are called after it.
pub(crate) const NAME_RULE: &str = "a name has 1 to 40 letters, digits, spaces, `-`, `_`, `+` or `.` and \
                             starts with a letter or a digit";

/// Whether a text is the name of a solver.
pub(crate) fn is_name(text: &str) -> bool {
    let allowed = |c: char| c.is_alphanumeric() || " -_+.".contains(c);
    text.chars().count() <= 40
        && text.chars().all(allowed)
        && text.starts_with(char::is_alphanumeric)
        && !text.ends_with([' ', '.'])
}

/// Why a text names no program.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotAnEntrant {
    #[error("`{text}` is not NAME=COMMAND, such as 'mine=python3 mine.py {{job}} {{answer}}'")]
    NoName { text: String },
    #[error("`{name}`: {NAME_RULE}")]
    Name { name: String },
    #[error("the command of {name} has a quotation mark that is not closed")]
    Quotation { name: String },
    #[error("the command of {name} lacks {placeholder}")]
    Placeholder { name: String, placeholder: &'static str },
}

impl FromStr for Entrant {
    type Err = NotAnEntrant;

    /// Words are separated as in a shell; no shell is started.
    fn from_str(text: &str) -> Result<Entrant, NotAnEntrant> {
        let parts = text.split_once('=').map(|(name, command)| (name.trim(), command.trim()));
        let named = parts.filter(|(name, command)| !name.is_empty() && !command.is_empty());
        let (name, command) = named.ok_or(NotAnEntrant::NoName { text: text.into() })?;
        let name = name.to_string();
        if !is_name(&name) {
            return Err(NotAnEntrant::Name { name });
        }
        let shown = command.to_string();
        let Some(command) = shlex::split(command) else {
            return Err(NotAnEntrant::Quotation { name });
        };
        for placeholder in [JOB, ANSWER] {
            if !command.iter().any(|word| word.contains(placeholder)) {
                return Err(NotAnEntrant::Placeholder { name, placeholder });
            }
        }
        Ok(Entrant { name, command, shown })
    }
}

impl Entrant {
    /// This solver with a recipe, through the same door as the others.
    pub fn own(program: &Path, name: &str, set: &[String]) -> Entrant {
        let words = ["protocol", "solve", JOB, ANSWER, "--threads", "1"].map(str::to_string);
        let set = set.iter().flat_map(|set| ["--set".to_string(), set.clone()]);
        let arguments: Vec<String> = words.into_iter().chain(set).collect();
        let shown = format!("mtled {}", arguments.join(" "));
        let program = program.to_string_lossy().into_owned();
        let command = std::iter::once(program).chain(arguments).collect();
        Entrant { name: name.into(), command, shown }
    }

    /// The command with the two files in place.
    pub(crate) fn words(&self, job: &Path, answer: &Path) -> Vec<String> {
        let (job, answer) = (job.to_string_lossy(), answer.to_string_lossy());
        let filled = |word: &String| word.replace(JOB, &job).replace(ANSWER, &answer);
        self.command.iter().map(filled).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_split_as_in_a_shell_and_paths_stay_one_word() {
        let text = "mine=python3 'my adapter.py' --job={job} {answer}";
        let entrant: Entrant = text.parse().unwrap();
        assert_eq!(entrant.name, "mine");
        let words = entrant.words(Path::new("/a b/job.json"), Path::new("/c"));
        assert_eq!(words, ["python3", "my adapter.py", "--job=/a b/job.json", "/c"]);
    }

    #[test]
    fn what_names_no_command_says_why() {
        for (text, part) in [
            ("python3 mine.py {job} {answer}", "is not NAME=COMMAND"),
            ("=x {job} {answer}", "is not NAME=COMMAND"),
            ("../evil=x {job} {answer}", "a name has 1 to 40 letters"),
            ("a/b=x {job} {answer}", "a name has 1 to 40 letters"),
            ("a=x '{job} {answer}", "quotation mark"),
            ("a=x {answer}", "lacks {job}"),
            ("a=x {job}", "lacks {answer}"),
        ] {
            let error = text.parse::<Entrant>().unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
