//! Counts idiom words, and comment lines that begin with a question word.

use crate::source::{Text, TextKind};

const QUESTIONS: [&str; 6] = ["What", "Whether", "Where", "How", "Who", "Which"];

/// Places of a count, and of how many words or lines they are.
pub struct Count {
    pub places: Vec<String>,
    pub words: usize,
}

/// Idioms of `idioms.txt` in all texts.
pub fn idioms(texts: &[Text]) -> Count {
    let idioms: Vec<Vec<&str>> = include_str!("idioms.txt")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(' ').collect())
        .collect();
    let mut count = Count { places: Vec::new(), words: 0 };
    for Text { path, line, words: text, .. } in texts {
        let lower = text.to_lowercase();
        let words: Vec<&str> = lower.split(|c: char| !c.is_alphabetic()).filter(|word| !word.is_empty()).collect();
        count.words += words.len();
        for idiom in &idioms {
            let hits = words.windows(idiom.len()).filter(|window| window == idiom).count();
            for _ in 0..hits {
                count.places.push(format!("{path}:{line}: {}: {text}", idiom.join(" ")));
            }
        }
    }
    count
}

/// Comment lines that begin with a question word.
pub fn openings(texts: &[Text]) -> Count {
    let comments = texts.iter().filter(|text| text.kind == TextKind::Comment);
    let mut count = Count { places: Vec::new(), words: 0 };
    for Text { path, line, words: text, .. } in comments {
        count.words += 1;
        let first = text.split(|c: char| !c.is_alphabetic()).next().unwrap_or_default();
        if QUESTIONS.contains(&first) {
            count.places.push(format!("{path}:{line}: {text}"));
        }
    }
    count
}
