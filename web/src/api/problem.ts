// Errors of the server in words that a person can act on.

import { asSentence, mistakeIn, own, type Said, sentenceIn, titleIn, withShortNumbers } from "../language/server-words.ts";
import { loadServerWords, serverWords, words } from "../language/words.ts";
import type { Problem } from "./types.ts";

/** An answer other than success. Status 0: no answer at all. */
export class ApiError extends Error {
  readonly status: number;
  readonly problem: Partial<Problem>;

  constructor(status: number, problem: Partial<Problem>) {
    super(problem.title ?? words().problems.answered(String(status)));
    this.name = "ApiError";
    this.status = status;
    this.problem = problem;
  }
}

/** What there is to say where no answer came at all. */
export function noAnswer(): ApiError {
  return new ApiError(0, { title: words().problems.noAnswer, detail: words().problems.noAnswerMore });
}

export function isWithoutAnswer(reason: unknown): boolean {
  return reason instanceof ApiError && reason.status === 0;
}

/** The problem document of an answer, or one made from its status where it carries none. */
export async function problemFromResponse(response: Response): Promise<Partial<Problem>> {
  const otherwise: Partial<Problem> = {
    title: words().problems.answered(`${response.status} ${response.statusText}`.trim()),
    status: response.status,
  };
  // They come before the problem is told.
  await loadServerWords();
  if (!(response.headers.get("content-type") ?? "").includes("json")) return otherwise;
  try {
    return { ...otherwise, ...((await response.json()) as Problem) };
  } catch {
    return otherwise;
  }
}

/** A headline and the sentences below it. */
export interface ProblemText {
  headline: Said;
  sentences: Said[];
}

export function describeProblem(reason: unknown): ProblemText {
  if (!(reason instanceof ApiError)) {
    const what = reason instanceof Error ? reason.message : String(reason);
    return { headline: own(words().problems.headline), sentences: [own(what)] };
  }
  const { problem, message } = reason;
  // What has no type is the viewer's.
  if (problem.type === undefined)
    return { headline: own(message), sentences: problem.detail === undefined ? [] : [own(problem.detail)] };
  const spoken = serverWords();
  const sentenceOf = (text: string) => sentenceIn(withShortNumbers(text), spoken);
  const mistakes = (problem.errors ?? []).map(({ parameter, value, message: mistake, code, allowed }): Said => {
    const name = value === undefined || value === null ? parameter : `${parameter} = ${withShortNumbers(value)}`;
    const said = mistakeIn(withShortNumbers(mistake), code, spoken);
    const sentence = words().problems.allowed(name, said.text, sentenceOf(allowed).text);
    return { text: sentence, isEnglish: said.isEnglish };
  });
  // The detail says the same of mistakes.
  const detail = mistakes.length > 0 || problem.detail === undefined ? [] : [asSentence(sentenceOf(problem.detail))];
  return { headline: titleIn(message, problem.type, spoken), sentences: [...detail, ...mistakes] };
}

/** The same in one line. */
export function problemLine(reason: unknown): Said {
  const { headline, sentences } = describeProblem(reason);
  const all = [asSentence(headline), ...sentences];
  return { text: all.map(({ text }) => text).join(" "), isEnglish: all.every(({ isEnglish }) => isEnglish) };
}
