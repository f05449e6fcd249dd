"""scripts/checks/words.py finds words and sentences that the style guide excludes, and nothing else."""

import pytest
from scripts.checks import words


@pytest.mark.parametrize("source, lines", [
    ("int a; /* The side that is told. */\n", [1]),
    ('puts("is told");\n// is told\n', [2]),
    ("/* A reported value. */\n/* Reports it\n * without end. */\n", [2]),
    ("/* without end (Zeno behaviour) */\n", []),
])  # fmt: skip
def test_comments_of_c(source, lines):
    found = [number for number, comment in words.c_comments(source) if list(words.wrong_words(comment))]
    assert found == lines


def test_comments_of_python():
    source = '"""Is told."""\nx = "is told"\n# to be had\n\n\ndef f():\n    """Whether what is."""\n    return "any more"\n'
    assert [number for number, comment in words.python_comments(source) if list(words.wrong_words(comment))] == [1, 3, 7]


@pytest.mark.parametrize("page, expected", [
    ("It is short. It is fine.", []),
    (" ".join(["It is a sentence."] * 5), ["a paragraph of 5 sentences"]),
    (" ".join(["It is a sentence."] * 4), []),
    ("\n\n".join(["It is a sentence."] * 7), []),
    ("\n".join(["- It is an item of a list."] * 7), []),
    ("```\n" + " ".join(["It is code."] * 7) + "\n```", []),
    ("word " * 25 + "word.", ["a sentence of 26 words"]),
    ("word " * 24 + "word.", []),
    ("- " + "word " * 13 + "\n  " + "word " * 13 + "\n- word.", ["a sentence of 26 words"]),
    ("word " * 23 + "is `a*b + c*d + e*f` = 3.5, F(t) = 2 + 3 x:", []),
    ("| it is told |", ["'is told'"]),
])  # fmt: skip
def test_pages(page, expected):
    assert [what for _, what, _ in words.faults_of_page(page)] == expected


@pytest.mark.parametrize("comment, lines", [
    ("/* " + "word " * 26 + "*/", [0]),
    ("/*\n * Short. " + "word " * 13 + "\n * " + "word " * 13 + "\n */", [1]),
    ("/*\n * " + "word " * 13 + "\n *   " + "word " * 13 + "\n */", []),
    ('"""\n    Short.\n\n    ' + "word " * 13 + "\n    " + "word " * 13 + '\n    """', [3]),
    ("# " + "word " * 25, []),
])  # fmt: skip
def test_sentences_of_comments(comment, lines):
    """Lines that are indented further, such as formulas, are not parts of sentences."""
    assert [number for number, _, _ in words.long_sentences(words.paragraphs_of_comment(comment))] == lines


def test_names():
    """Names by their words, whatever joins these; comments and strings do not count."""
    source = 'int is_told;\nint toldings, hold;\nchar s[] = "settle"; /* held */\nstruct PlaneFacts f;\nconst goOn = 1;\nint let_go, on;\n'
    assert [number for number, _, _ in words.wrong_names(source)] == [1, 4, 5]


@pytest.mark.parametrize("call, lines", [
    ('report_at(reader, node, "a <stop> has no limit; expected one");', []),
    ('report_at(reader, node,\n          "a <stop> has "\n          "no limit");', [2]),
    ('FAIL(parser, "%s: expected \'%c\', found %s%s", what, c, text, hint);', []),
    ('report_error(diagnostics, 0, "unknown name%s", hint);', []),
    ('copy_text("a sentence");', []),
])  # fmt: skip
def test_messages(call, lines):
    assert [number for number, _, _ in words.messages_without_remedy(call)] == lines


def test_functions_that_are_gone(tmp_path):
    """A comment may name a function of any file; a name that no code has is found with its line."""
    (tmp_path / "a.c").write_text("/* Calls first() and\n * second(). */\nint first(void);\n// see third(), gone()\n")
    (tmp_path / "b.py").write_text("def third():\n    pass\n\n\ndef second():\n    pass\n")
    found = words.missing_functions([tmp_path / "a.c", tmp_path / "b.py"])
    assert [(path.name, number, what) for path, number, what, _ in found] == [("a.c", 4, "gone(), which does not exist")]
