"""Journals, in which ``robophm watch`` keeps the samples of a live run for an exact replay."""

from __future__ import annotations

from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.journal import TITLE, JournalRecording

FORMAT = SampleFormat((".journal",), lambda head: head.startswith(TITLE), JournalRecording, in_folders=False)
