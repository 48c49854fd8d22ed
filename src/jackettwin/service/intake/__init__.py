"""Intake of records: uploads, folders, streams.

Every way ends in :func:`jackettwin.service.intake.files.accept`.
"""
