"""The zoo: random drives of every size and kind, each with nameplate, recording and truth, from one seed."""
