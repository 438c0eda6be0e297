/* @TITLE@: creep forces, written by tractive_sam.

   int @NAME@(@GIVEN@, force, gradient)

   Creepages and spin (1/mm; one of the three may be infinite)@MEANS@.
   It fills force[3] with Qx, Qy (N) and Mz (N mm) on body A and, unless it is null,
   gradient[9] with their derivatives by xi_x, xi_y, spin, those of Qx first. A load of 0 gives
   zeros. Returns 0; 1 if a creepage is no number or several are infinite, 2 if a property is not positive
   and finite, 3 if a/b is not from @LOW@ to @HIGH@, 4 if another value is outside the table:
@RANGES@   arrays are left as they are then. Tolerance over mu P: @TOLERANCE@.
@GRADIENTS@ */
#ifndef @GUARD@
#define @GUARD@
#ifdef __cplusplus
extern "C" {
#endif
int @NAME@(@ARGUMENTS@,
           double force[3], double *gradient);
#ifdef __cplusplus
}
#endif
#endif
