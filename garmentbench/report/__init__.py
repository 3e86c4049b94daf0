"""Tools of a report: tables, plots, strips of frames, a page. Which of them there are, the experiments say."""
