"""Journals, in which ``robophm watch`` keeps the samples of a live run for an exact replay."""

from __future__ import annotations

from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.journal import JournalRecording
from robophm.transports.recordings.journal_lines import NAME

FORMAT = SampleFormat((".journal",), lambda head: head.startswith(NAME), JournalRecording, in_folders=False)
