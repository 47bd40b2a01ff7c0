use super::*;

fn tokens(text: &str) -> String {
    ptb_tokens(text).join(" ")
}

#[test]
fn every_shape_has_its_example() {
    for (number, row) in SHAPE_ROWS.iter().enumerate() {
        let example: Vec<char> = row.example.chars().collect();
        let alone = TokenShapes::new([row.shape]);
        let found = alone.longest_match(&example, |_, length| token_length(number, &example, length) > 0);
        assert_eq!(found, Some((0, example.len())), "{} {}", row.shape, row.example);
    }
}

#[test]
fn punctuation_is_left_out_and_brackets_are_kept() {
    assert_eq!(
        tokens("Turn left, then (slowly) stop; wait... \"here\"."),
        "turn left then -lrb- slowly -rrb- stop wait here"
    );
    assert_eq!(tokens("What?! No -- really!!"), "what ?! no really !!");
}

#[test]
fn short_forms_are_two_tokens() {
    assert_eq!(tokens("Don't, you'll see it's the dog's."), "do n't you 'll see it 's the dog 's");
    assert_eq!(tokens("I cannot, gonna, gimme"), "i can not gon na gim me");
    assert_eq!(tokens("It’s o’clock"), "it 's o’clock");
}

#[test]
fn abbreviations_keep_their_full_stop() {
    assert_eq!(tokens("Mr. Fig. 5 of No. 7, at 5 p.m. etc."), "mr. fig. 5 of no. 7 at 5 p.m. etc.");
    assert_eq!(tokens("No. Go to the fig."), "no go to the fig");
}

/// A letter with a full stop is an abbreviation, unless the next word often begins a sentence.
#[test]
fn a_room_with_a_letter_may_end_a_sentence() {
    assert_eq!(tokens("Go to bedroom b. Turn left."), "go to bedroom b. turn left");
    assert_eq!(tokens("Go to bedroom b. Then turn left."), "go to bedroom b then turn left");
}

#[test]
fn numbers_and_words_may_hold_signs() {
    assert_eq!(
        tokens("the left-hand door, 3.5 m, 1,000, 1/2, 10:30, 2nd"),
        "the left-hand door 3.5 m 1,000 1/2 10:30 2nd"
    );
    assert_eq!(tokens("kitchen.Turn"), "kitchen.turn");
    assert_eq!(tokens("and/or 1 1/2"), "and/or 1\u{a0}1/2");
}

#[test]
fn line_breaks_are_white_space() {
    assert_eq!(tokens("Go\n\n up \t the\u{a0}stairs\r\n"), "go up the stairs");
    assert_eq!(tokens(" \n"), "");
}

#[test]
fn ptb_handles_letters_and_signs_beyond_ascii() {
    assert_eq!(tokens("L'été à 5 £, ½ café «naïve» — 😀"), "l'été à 5 # 1/2 café naïve");
}
