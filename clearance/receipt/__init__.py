"""A certified bound that anyone can prove again: a receipt of each run, and its verification by other means.

`proof` holds all that decides about bounds; `case_data` takes a case apart for it, `receipt_file` is the format,
`search` finds the evidence, `verification` asks for it, and `verifying` holds the report against its case. Not
for: measuring and certifying (room `simulate`).
"""
