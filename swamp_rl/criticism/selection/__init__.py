"""The search over hypotheses: score tests, criterion, beam search, elimination, stepwise selection."""
