"""A robot's design drafted from its description, its recordings and its parts lists, with what each part rests on."""

from __future__ import annotations

from robophm.drafting.answers import Answers, Question, questions
from robophm.drafting.bindings import Proposal, proposals
from robophm.drafting.composing import Change, change_of
from robophm.drafting.drafting import Draft, drafted, evidence, new
from robophm.drafting.seen import look

__all__ = [
    "Answers",
    "Change",
    "Draft",
    "Proposal",
    "Question",
    "change_of",
    "drafted",
    "evidence",
    "look",
    "new",
    "proposals",
    "questions",
]
