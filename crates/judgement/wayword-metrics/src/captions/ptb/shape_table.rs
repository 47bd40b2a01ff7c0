//! The table of token patterns: for each kind of token its pattern, how much of a match becomes the token, and an example.
//!
//! The table was derived by running the reference tokenizer on made-up strings: all short ones over small alphabets, and millions
//! of random ones. None of its code was used.

/// How much of a match becomes the token, and under which condition. Reading goes on after the token, within the match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TokenExtent {
    /// The whole match.
    All,
    /// The whole match, unchanged: soft hyphens are kept.
    Address,
    /// This many characters from the beginning: `cannot` gives `can`.
    First(usize),
    /// The match without this many characters at its end: `don't` gives `do`.
    AllBut(usize),
    /// The whole match, if it is a known abbreviation with its full stop.
    Abbreviation,
    /// The whole match, if a blank or the end of the text comes after it.
    BeforeBlank,
    /// The first character, if a blank or the end of the text comes after the match: `a. Then` gives `a`.
    BeforeSentence,
    /// The whole match, if a blank, a comma, the end of a sentence or of the text comes after it.
    File,
    /// The whole match, if no letter comes after it.
    NotBeforeLetter,
    /// The whole match, if no letter or digit comes after it.
    NotInWord,
    /// The match up to its full stop, if it is an abbreviation that often ends a sentence: `etc.a` gives `etc.`.
    BeforeLetter,
    /// The match up to its full stop, if it is an abbreviation before numbers: `No. 5` gives `No.`.
    BeforeNumber,
}

use TokenExtent::{
    Abbreviation, Address, All, AllBut, BeforeBlank, BeforeLetter, BeforeNumber, BeforeSentence, File, First,
    NotBeforeLetter, NotInWord,
};

/// One kind of token.
#[derive(Debug)]
pub(super) struct ShapeRow {
    /// Its pattern, in the syntax of [`super::shape`].
    pub(super) shape: &'static str,
    /// How much of a match is the token.
    pub(super) taken: TokenExtent,
    /// A token of this kind.
    #[cfg(test)]
    pub(super) example: &'static str,
}

macro_rules! rows {
    ($($shape:expr, $taken:expr, $example:expr;)*) => {
        &[$(ShapeRow { shape: $shape, taken: $taken, #[cfg(test)] example: $example }),*]
    };
}

/// All kinds of tokens. The longest match wins; of equally long ones the first row.
pub(super) const SHAPE_ROWS: &[ShapeRow] = rows! {
    // Marks of web pages and addresses.
    "</?[a-z][a-z0-9_:.\\-]*>|<[a-z][a-z0-9_:.\\-]*( +[a-z][a-z0-9_:.\\-]*( *= *(\"[^\"]*\"|'[^']*'))?)* */?>|<[!?][a-z\\-][^>]*>", Address, "<b class=\"x\">";
    "&(amp|lt|gt|quot|apos|nbsp|mdash|ndash);", All, "&amp;";
    "&([aeiou](acute|grave|uml)|#{digit}+|ht|lr|md|q[clr]|tl|ur);", Address, "&eacute;";
    "https?://[^ \"<>|(){}]+[^ \"<>|().!?,{}\\-]", Address, "https://a.b/c?d=e";
    "www\\.([^ \"<>|.!?,(){}]+\\.)+[a-z][a-z][a-z]?[a-z]?(/[^ \"<>|()]+[^ \"<>|().!?,{}\\-])?", Address, "www.a.com/bc";
    "(<|&lt;)?[a-z0-9][^ \"<>|(){}]*@([^ \"<>|().{}]+\\.)*[^ \"<>|().{}]+>?", Address, "a.b@c.d";
    "@[a-z_][a-z0-9_]*", All, "@name";
    "#{soft}+", Address, "#tag";

    // Words that are two tokens, and words with an apostrophe.
    "cannot", First(3), "cannot";
    "(gon|wan)na", First(3), "gonna";
    "gotta", First(3), "gotta";
    "(lem|gim)me", First(3), "gimme";
    "'t(is|was)", First(2), "'twas";
    "more{apostrophe}{small n}", AllBut(2), "more'n";
    "([a-z]|{hyphen})*n({apostrophe}|`)t", AllBut(3), "don't";
    "n({apostrophe}|`)t", All, "n't";
    "{soft}({soft}|{digit})*([.!?]{soft}({soft}|{digit})*)*{apostrophe}[smd]", AllBut(2), "gonna's";
    "{soft}({soft}|{digit})*([.!?]{soft}({soft}|{digit})*)*{apostrophe}(re|ve|ll)", AllBut(3), "they've";
    "'([smd]|re|ve|ll)", NotBeforeLetter, "'ve";
    "[’\u{92}]([smd]|re|ve|ll|n)", All, "’ve";
    "{apostrophe}(em|till?|cause|n{apostrophe})", All, "'em";
    "'n", BeforeBlank, "'n";
    "'[a-z][a-z]", First(1), "'an";
    "{apostrophe}[2-9]0s", All, "'90s";
    "{apostrophe}{digit}{digit}", BeforeBlank, "'90";
    "y{apostrophe}{letter}", AllBut(1), "y'a";
    "[dljDLJ]{apostrophe}|ol{apostrophe}", All, "ol'";
    "[dlo]{quote}({letter}|{digit})({letter}|{digit})+", All, "d'un";
    "n{quote}{letter}{letter}+|[A-HJ-XZ]{quote}{letter}{letter}+", All, "M'Bala";
    "{letter}+[aeiouy]{quote}[aeiouA-Z]{letter}*", All, "ma'am";
    "ev{apostrophe}ry|e{apostrophe}er|c{apostrophe}mon|cap{apostrophe}n|li{apostrophe}l|nat{apostrophe}l|o{apostrophe}o", All, "c'mon";

    // Abbreviations.
    // "Go to bedroom a. Then turn": words that often begin a sentence.
    "[a-z]\\. +(A|About|According|Additionally|After|An|As|At|But|Earlier|He|Her|Here|However|If|In|It|Last|Many|More|Now|Once|One|Other|Our|She|Since|So|Some|Such|That|The|Their|Then|There|These|They|This|We|What|When|While|Yet|You|M[rs]\\.|</?[a-z][a-z0-9_:.\\-]*>|<[a-z][a-z0-9_:.\\-]*( +[a-z][a-z0-9_:.\\-]*( *= *(\"[^\"]*\"|'[^']*'))?)* */?>|<[!?][a-z\\-][^>]*>)", BeforeSentence, "a. Then";
    "[a-z]\\.", All, "B.";
    "([a-z]\\.)+[a-z]\\.", All, "u.s.";
    "{letter}+\\.", Abbreviation, "Mr.";
    "{letter}+\\.-?({letter}|{digit})", BeforeLetter, "etc.a";
    "{letter}+\\. ?{digit}", BeforeNumber, "No. 5";
    "ph\\.d\\.", All, "Ph.D.";
    "ph\\.d\\.-?({letter}|{digit})", First(5), "Ph.D.s";
    "[A-Z]+(([&+]|&amp;)[A-Z]+)+", All, "AT&T";

    // Words and numbers, alone and joined.
    "(({soft}|{digit})+\\.)+(bat|bmp|c|cgi|cpp|dll|docx?|exe|gif|gz|h|html?|jar|java|jpe?g|mov|pdf|php|pl|png|ppt|ps|py|sql|tar|txt|wav|x|xml|zip)", File, "1.jpg";
    "{soft}({soft}|{digit})*([.!?]{soft}({soft}|{digit})*)*", All, "kitchen.Turn";
    "(([#%&*+~]|{small}|{high})+\\.)+(com|net|org|edu)(/[^ \"<>|()]+[^ \"<>|().!?,{}\\-])?", Address, "a.com/bc";
    "({letter}|{digit})+", All, "2nd";
    "([dlo]{quote}({letter}|{digit})({letter}|{digit})+|({letter}|{digit})+)([_\\-]([dlo]{quote}({letter}|{digit})({letter}|{digit})+|({letter}|{digit})+))+", All, "left-hand";
    "[a-z0-9]([a-z0-9.,]|{hyphen})*(-([a-z0-9]|{hyphen})+)+", All, "U.S.-led";
    "[a-z0-9]([a-z0-9.,]|{hyphen})*(-([a-z0-9]|{hyphen})+)*-([a-z]\\.)+[a-z]\\.(-({letter}|{digit})+)*", All, "non-U.S.";
    "[a-z0-9]+(-[a-z]+)?(-[a-z]+)?(\\\\?/[a-z0-9]+(-[a-z]+)?(-[a-z]+)?)(\\\\?/[a-z0-9]+(-[a-z]+)?(-[a-z]+)?)?", All, "left-hand/right-hand";
    "({soft}({soft}|{digit})*([.!?]{soft}({soft}|{digit})*)*|([dlo]{quote}({letter}|{digit})({letter}|{digit})+|({letter}|{digit})+)|([dlo]{quote}({letter}|{digit})({letter}|{digit})+|({letter}|{digit})+)([_\\-]([dlo]{quote}({letter}|{digit})({letter}|{digit})+|({letter}|{digit})+))+|[a-z0-9]([a-z0-9.,]|{hyphen})*(-([a-z0-9]|{hyphen})+)+|[A-Z]+([&+][A-Z]+)+)\\.[,;:]", AllBut(1), "hall.,";
    "[+\\-]?({hyphen}?|[.,:]){digit}({hyphen}?{digit})*([.,:]{digit}({hyphen}?{digit})*)*", All, "-1,000.5";
    "{digit}{digit}?[/\\-]{digit}{digit}?[/\\-]{digit}{digit}{digit}?{digit}?", All, "1/2-2004";
    "[¹²³]+", All, "²";
    "[½¼¾⅓⅔]", All, "½";
    "\\({digit}{digit}{digit}?\\) ?{digit}{digit}{digit}{digit}?[ \\-]?{digit}{digit}{digit}{digit}?{digit}?", All, "(555) 555-1234";
    "(\\+\\+?)?{digit}{digit}{digit}?{digit}?[ \\-]({digit}{digit}{digit}?{digit}?[ \\-])?{digit}{digit}{digit}{digit}?[ \\-]?{digit}{digit}{digit}{digit}?{digit}?", All, "+44 20 1234 5678";
    "{digit}{digit}?{digit}?{digit}?[ \\-]{digit}{digit}?{digit}?{digit}?\\\\?/{digit}{digit}?{digit}?{digit}?", All, "1 1/2";
    "{digit}+\\\\?/{digit}+", All, "1/2";
    "[A-Z]+\\$", All, "US$";

    // Faces.
    "[<>]?[:;=]([*'\\-]|{small o})?([()@\\[\\]{\\\\|d-dp-p]|O)", NotInWord, ":-)";
    "([<=>^~'\\-]|{small x})_([<=>^~'\\-]|{small x})|\\(([<=>^~'\\-]|{small x})_?([<=>^~'\\-]|{small x})\\)", All, "(^_^)";
    "o['`._]o", All, "o.O";

    // Signs of several characters.
    "(anti|pro)-", All, "pro-";
    "-[lr][rcs]b-", All, "-LRB-";
    "c\\+\\+|[cf]#", All, "c#";
    "\\\\\\*", All, "\\*";
    "\\.\\.\\.+|\\. \\. \\.", All, "...";
    "--+", All, "--";
    "[?!][?!]+", All, "?!";
    "__+", All, "___";
    "\\*+", All, "**";
    "##+", All, "##";
    "@@+", All, "@@";
    "<<|>>", All, "<<";
    "''|[`«»‘’“”‹›\u{91}-\u{94}][`«»‘’“”‹›\u{91}-\u{94}]", All, "''";
};
